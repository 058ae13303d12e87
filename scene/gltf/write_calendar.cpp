#include "scene/gltf/write_calendar.h"

namespace scenegen::gltf {

void emit_calendar(const Calendar& calendar, TextOut& out) {
  out.raw(R"(,"calendar":{"start":)");
  out.string(calendar.start);
  out.raw(R"(,"secondsPerDay":)");
  out.number(calendar.seconds_per_day);
  out.raw(R"(,"tasks":[)");
  Commas commas(out);
  for (const CalendarTask& task : calendar.tasks) {
    commas.next().raw(R"({"id":)");
    out.string(task.id);
    out.raw(R"(,"name":)");
    out.string(task.name);
    out.raw(R"(,"type":)");
    out.string(task.type);
    out.raw(R"(,"start":)");
    out.number(task.start_s);
    out.raw(R"(,"finish":)");
    out.number(task.finish_s);
    out.raw("}");
  }
  out.raw("]}");
}

}  // namespace scenegen::gltf
