// asset.extras.scenegen.calendar: what day it is at a time of the timeline, and what is being worked at.
const kDayMs = 86_400_000;

/// null where the file has no calendar, or one that says nothing.
export function calendarOf(json) {
  const calendar = json.asset?.extras?.scenegen?.calendar;
  const start = Date.parse(/T/.test(calendar?.start ?? '') ? `${calendar.start}Z` : calendar?.start);  // no zone: as written
  if (calendar === undefined || Number.isNaN(start) || !(calendar.secondsPerDay > 0)) return null;
  const tasks = (calendar.tasks ?? []).filter((task) => Number.isFinite(task.start) && Number.isFinite(task.finish));
  const dayFormat = new Intl.DateTimeFormat(undefined, { weekday: 'short', day: 'numeric', month: 'short', year: 'numeric', timeZone: 'UTC' });
  const hourFormat = new Intl.DateTimeFormat(undefined, { hour: '2-digit', minute: '2-digit', timeZone: 'UTC' });
  const dateAt = (time_s) => new Date(start + time_s / calendar.secondsPerDay * kDayMs);
  return {
    tasks,
    dateAt,
    dayAt: (time_s) => dayFormat.format(dateAt(time_s)),
    /// Hours only where a day takes long enough to read them.
    hourAt: (time_s) => (calendar.secondsPerDay >= 12 ? hourFormat.format(dateAt(time_s)) : ''),
    tasksAt: (time_s) => tasks.filter((task) => task.start <= time_s && time_s < Math.max(task.finish, task.start + 1e-6)),
  };
}
