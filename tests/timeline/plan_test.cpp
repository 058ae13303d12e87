// Plans: every rule of docs/SCHEDULES.md, and what is said of plans that break one.
#include <catch2/catch.hpp>
#include <map>

#include "timeline/schedule/plan.h"
#include "timeline/schedule/plan_values.h"

using namespace scenegen;
using namespace scenegen::timeline;

namespace {

Plan good(const std::string& text, const PlanOptions& options = {}) {
  auto plan = parse_plan(text, "plan.csv", options);
  if (!plan) FAIL(plan.error().str() << "\n" << text);
  return std::move(*plan);
}

/// "1 2024-03-01 2024-03-06 construct; …"
std::string dates(const Plan& plan) {
  std::string out;
  for (const Task& t : plan.tasks) {
    out += (out.empty() ? "" : "; ") + t.id + " " + moment_text(*t.start_s) + " " + moment_text(*t.finish_s);
  }
  return out;
}

std::string error_of(const std::string& text, const PlanOptions& options = {},
                     const char* name = "plan.csv") {
  const auto plan = parse_plan(text, name, options);
  if (plan) FAIL("no error in\n" << text);
  CHECK(plan.error().kind == ErrorKind::bad_input);
  CHECK(plan.error().str().find('\n') == std::string::npos);
  return plan.error().str();
}

std::string moment(const char* text, DateOrder order = DateOrder::unknown) {
  const auto parsed = parse_moment(text, order);
  return parsed ? moment_text(parsed->at_s) : parsed.error().what;
}

std::string duration(const char* text) {
  const auto parsed = parse_duration(text);
  return parsed ? std::to_string(*parsed) : parsed.error().what;
}

std::string xml(const std::string& inner,
                const std::string& project = "<StartDate>2024-03-01T08:00:00</StartDate>") {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<Project xmlns="http://schemas.microsoft.com/project">)" +
         project + "<Tasks>" + inner + "</Tasks></Project>";
}

std::string xml_error(const std::string& text) {
  return error_of(text, {}, "plan.xml");
}

}  // namespace

TEST_CASE("dates are read when they can mean only one day") {
  CHECK(moment("2024-03-01") == "2024-03-01");
  CHECK(moment(" 2024-3-1 ") == "2024-03-01");
  CHECK(moment("20240301") == "2024-03-01");
  CHECK(moment("2024/03/01") == "2024-03-01");
  CHECK(moment("2024-03-01T08:30") == "2024-03-01T08:30:00");
  CHECK(moment("2024-03-01 08:30:15.5") == "2024-03-01T08:30:15");
  CHECK(moment("2024-03-01T08:30Z") == "2024-03-01T08:30:00");
  CHECK(moment("2024-02-29T24:00") == "2024-03-01");
  CHECK(moment("1969-12-31T23:00") == "1969-12-31T23:00:00");
  CHECK(moment("0001-01-01") == "0001-01-01");
  CHECK(moment("13.03.2024") == "2024-03-13");
  CHECK(moment("03/13/2024") == "2024-03-13");
  CHECK(moment("5.5.2024") == "2024-05-05");
  CHECK(moment("1-Mar-2024") == "2024-03-01");
  CHECK(moment("1 march 2024 07:00") == "2024-03-01T07:00:00");
  CHECK(moment("3.4.2024", DateOrder::day_month_year) == "2024-04-03");
  CHECK(moment("3.4.2024", DateOrder::month_day_year) == "2024-03-04");

  CHECK(moment("Wed 3.4.24") == "2024-04-03");
  CHECK(moment("Mon 3/4/24 08:00") == "2024-03-04T08:00:00");
  CHECK(moment("Mi 10.04.24") == "2024-04-10");
  CHECK(moment("Mo. 04.03.2024") == "2024-03-04");
  CHECK(moment("Wednesday, 3 April 2024") == "2024-04-03");
  CHECK(moment("Tue 1969-12-30") == "1969-12-30");
  CHECK(moment("Mon 10.04.24") == "'Mon 10.04.24': is no Monday but a Wednesday");
  CHECK(moment("Wed 3.4.24", DateOrder::month_day_year) == "'Wed 3.4.24': is no Wednesday but a Monday");
  CHECK(moment("Sat 3/2/24") ==
        "'Sat 3/2/24': may be day or month first, a Saturday both; write YYYY-MM-DD, or say --date-order dmy "
        "or mdy");
  CHECK(moment("Sat 3/2/24", DateOrder::month_day_year) == "2024-03-02");
  CHECK(moment("Sat 30/30/24") == "'Sat 30/30/24': there is no month 30");
  CHECK(moment("Sat") == "'Sat': wanted a date YYYY-MM-DD, with a time YYYY-MM-DDTHH:MM");
  CHECK(moment("Sat 5") == "'Sat 5': wanted a date YYYY-MM-DD, with a time YYYY-MM-DDTHH:MM");

  CHECK(moment("3.4.2024") ==
        "'3.4.2024': may be day or month first; write YYYY-MM-DD, or say --date-order dmy or mdy");
  CHECK(moment("03/13/2024", DateOrder::day_month_year) == "'03/13/2024': there is no month 13");
  CHECK(moment("30/30/2024") == "'30/30/2024': there is no month 30");
  CHECK(moment("2024-02-30") == "'2024-02-30': February 2024 has 29 days");
  CHECK(moment("2024-13-01") == "'2024-13-01': there is no month 13");
  CHECK(moment("0000-01-01") == "'0000-01-01': years go from 1 to 9999");
  CHECK(moment("1.3.24") == "'1.3.24': the year needs four digits");
  const std::string wanted = ": wanted a date YYYY-MM-DD, with a time YYYY-MM-DDTHH:MM";
  CHECK(moment("soon") == "'soon'" + wanted);
  CHECK(moment("2024-03") == "'2024-03'" + wanted);
  CHECK(moment("08:00") == "'08:00'" + wanted);
  CHECK(moment("1-Mrz-2024") == "'1-Mrz-2024'" + wanted);
  CHECK(moment("2024-03-01T25:00") == "'2024-03-01T25:00': a day goes from 00:00 to 24:00");
  CHECK(moment("2024-03-01T08:60") == "'2024-03-01T08:60': a day goes from 00:00 to 24:00");
  CHECK(moment("2024-03-01T8:") == "'2024-03-01T8:': wanted a time HH:MM or HH:MM:SS behind the date");
  CHECK(moment("2024-03-01T08:00+01:00") ==
        "'2024-03-01T08:00+01:00': has a time zone; write the time of the site without one");
}

TEST_CASE("durations have units, days when they have none") {
  const std::map<const char*, const char*> good_ones{
      {"5", "432000"},    {"5d", "432000"},       {"2w", "1209600"},     {"8h", "28800"},
      {"30 min", "1800"}, {"2.5 days", "216000"}, {"5 days?", "432000"}, {"1 ew", "604800"},
      {"0", "0"},         {"P5D", "432000"},      {"PT8H0M0S", "28800"}, {"P0Y0M1DT12H", "129600"},
      {"P1W", "604800"},  {"PT0.5S", "1"}};
  for (const auto& [text, wanted] : good_ones) {
    INFO(text);
    CHECK(duration(text) == wanted);
  }
  const std::string wanted =
      ": wanted a duration: a number of days, or with a unit w, d, h or min (5, 2w, 8h, PT8H)";
  for (const char* text : {"d", "5 m", "five", "5,5", "P", "PT", "P5", "PT5D", "P5H", "PT5M4H", "P-5D"}) {
    INFO(text);
    CHECK(duration(text) == "'" + std::string(text) + "'" + wanted);
  }
  CHECK(duration("-5d") == "'-5d': a duration cannot be negative");
  CHECK(duration("P1M") == "'P1M': months and years differ in length; say it in days");
  CHECK(duration("40000d") == "'40000d': is longer than 100 years");
  CHECK(duration("inf") == "'inf': is longer than 100 years");
  CHECK(duration("nan") == "'nan': is longer than 100 years");
}

TEST_CASE("types are understood as IFC and Navisworks call them") {
  const std::map<const char*, Profile> words{
      {"Construct", Profile::construct},    {"CONSTRUCTION", Profile::construct},
      {"Installation", Profile::construct}, {"demolish", Profile::demolish},
      {"DISMANTLE", Profile::demolish},     {"removal", Profile::demolish},
      {"Temporary", Profile::temporary},    {"MOVE", Profile::move},
      {"operation", Profile::operate},      {"MAINTENANCE", Profile::operate},
      {"Renovation", Profile::operate},     {"attendance", Profile::operate},
      {"LOGISTIC", Profile::operate},       {"NOT_DEFINED", Profile::neutral},
      {"not defined", Profile::neutral},    {"drop", Profile::drop},
      {"appear", Profile::appear}};
  for (const auto& [word, profile] : words) {
    INFO(word);
    REQUIRE(parse_task_type(word));
    CHECK(*parse_task_type(word) == profile);
  }
  CHECK(parse_task_type("constrct").error().str() ==
        "unknown type 'constrct' (did you mean 'construct'? one of: construct, demolish, temporary, move, "
        "operate, "
        "neutral, appear, drop)");
  CHECK(parse_task_type("walk").error().str() ==
        "unknown type 'walk' (one of: construct, demolish, temporary, move, operate, neutral, appear, drop)");
}

TEST_CASE("a CSV plan is read whatever its columns are called and separated by") {
  const std::string wanted = "1 2024-03-01 2024-03-06; 2 2024-03-08 2024-03-09T12:00:00";
  CHECK(dates(good("id,name,start,duration,predecessors\n1,a,2024-03-01,5,\n2,b,,36h,1FS+2d\n")) == wanted);
  CHECK(dates(good("\r\n\nid;name;start;duration;predecessors\n1;a;2024-03-01;5;\n2;b;;36h;1FS+2d\n")) ==
        wanted);
  CHECK(dates(good(
            "\xEF\xBB\xBFTask ID;Task_Name;Planned Start;Duration;Predecessors\r\n1;a;2024-03-01;5d;\r\n\r\n"
            "2;b;;1.5;\"1fs+2 days\"")) == wanted);
  CHECK(dates(good(
            "sep=\t\nname\tSTART\tduration\tpredecessor\na\t2024-03-01\t5\t\n\nb\t\t36 h\t1 FS + 2 d\n")) ==
        wanted);
  CHECK(dates(good("sep=;\rid;name;start;duration;predecessors\r1;a;2024-03-01;5;\r\r2;b;;36h;1FS+2d\r")) ==
        wanted);
  const Plan plan = good(
      "ID,Name,Start,Finish,Type,Objects,Selector,Offset,Cost\n"
      "A,\"walls,\n\"\"all\"\" of them\",2024-03-01,2024-03-01,install,\"w 1; "
      "0aB$;\nsubtree=S*\",name~^x;y,1 -2.5 3,12\n"
      "B,,2024-03-02T06:00,2024-03-02T18:00,,,,,\n");
  REQUIRE(plan.tasks.size() == 2);
  CHECK(plan.tasks[0].name == "walls,\n\"all\" of them");
  CHECK(plan.tasks[0].objects == std::vector<std::string>{"w 1", "0aB$", "subtree=S*"});
  CHECK(plan.tasks[0].selectors == std::vector<std::string>{"name~^x;y"});
  CHECK(plan.tasks[0].offset_z_up_m == glm::vec3(1, -2.5, 3));
  CHECK(plan.tasks[0].where == "plan.csv: line 2");
  CHECK(plan.tasks[1].name == "B");
  CHECK(plan.tasks[1].where == "plan.csv: line 5");
  CHECK(dates(plan) == "A 2024-03-01 2024-03-02; B 2024-03-02T06:00:00 2024-03-02T18:00:00");
  CHECK(plan.notes == std::vector<std::string>{"plan.csv: columns without a meaning here: 'Cost'"});
}

TEST_CASE("dates that are missing come from predecessors, from summaries and from tasks below") {
  const auto of = [](const std::string& rows) {
    return dates(good("id,start,finish,duration,parent,predecessors\n" + rows));
  };
  CHECK(of("1,2024-03-01,,5,,\n2,,,2,,1\n") == "1 2024-03-01 2024-03-06; 2 2024-03-06 2024-03-08");
  CHECK(of("1,2024-03-01,,5,,\n2,,,2,,1SS+1\n") == "1 2024-03-01 2024-03-06; 2 2024-03-02 2024-03-04");
  CHECK(of("1,2024-03-01,,5,,\n2,,,2,,1FF\n") == "1 2024-03-01 2024-03-06; 2 2024-03-04 2024-03-06");
  CHECK(of("1,2024-03-11,,5,,\n2,,,2,,1SF-1d\n") == "1 2024-03-11 2024-03-16; 2 2024-03-08 2024-03-10");
  CHECK(of("1,2024-03-01,,5,,\n2,2024-03-01,,9,,\n3,,,1,,1;2FS-1w\n") ==
        "1 2024-03-01 2024-03-06; 2 2024-03-01 2024-03-10; 3 2024-03-06 2024-03-07");
  CHECK(of("2,,,1,,1\n1,,2024-03-05,2,,\n") == "2 2024-03-06 2024-03-07; 1 2024-03-04 2024-03-06");
  CHECK(of("2,,2024-03-20,,,1\n1,2024-03-01,,0,,\n") == "2 2024-03-01 2024-03-21; 1 2024-03-01 2024-03-01");
  // A summary spans what is below it; what depends on it waits for all of that.
  CHECK(of("S,,,,,\n1,2024-03-01,,5,S,\n2,,,2,S,1\n3,,,1,,S\n") ==
        "S 2024-03-01 2024-03-08; 1 2024-03-01 2024-03-06; 2 2024-03-06 2024-03-08; 3 2024-03-08 2024-03-09");
  // Tasks below a summary that say nothing start when the summary may.
  CHECK(of("0,2024-03-01,,5,,\nS,,,,,0FS+1\n1,,,5,S,\n2,,,2,S,\n") ==
        "0 2024-03-01 2024-03-06; S 2024-03-07 2024-03-12; 1 2024-03-07 2024-03-12; 2 2024-03-07 2024-03-09");
  CHECK(of("S,2024-03-03,,,,\n1,,,5,S,\n") == "S 2024-03-03 2024-03-08; 1 2024-03-03 2024-03-08");
  // Ids that look like links.
  CHECK(
      of("A-1,2024-03-01,,5,,\nA,2024-04-01,,5,,\n3,,,1,,A-1\n4,,,1,,A-1FS+1d\n") ==
      "A-1 2024-03-01 2024-03-06; A 2024-04-01 2024-04-06; 3 2024-03-06 2024-03-07; 4 2024-03-07 2024-03-08");
  // Given dates win over durations: those of other programs count working days.
  CHECK(of("1,2024-03-01,2024-03-10,6,,\n") == "1 2024-03-01 2024-03-11");
}

TEST_CASE("CSV plans that are wrong say where and what") {
  const std::string list =
      "id, name, start, finish, duration, type, parent, predecessors, objects, selector, offset";
  const std::map<std::string, std::string> cases{
      {"", "plan.csv: is empty; wanted CSV with a first line of columns (" + list + "), or MS Project XML"},
      {"\n\n",
       "plan.csv: is empty; wanted CSV with a first line of columns (" + list + "), or MS Project XML"},
      {"id,start\n", "plan.csv: has no tasks below its first line"},
      {"when,where\n1,2\n", "plan.csv: line 1: no column 'id' or 'name' (columns: " + list + ")"},
      {"id,name\n1,2\n", "plan.csv: line 1: no column 'start' or 'finish'"},
      {"id,Start,start_date\n", "plan.csv: line 1: columns 'Start' and 'start_date' mean the same"},
      {"id,start\n1,2024-01-01\n\n2\n", "plan.csv: line 4: 1 cell; the first line has 2"},
      {"id,start\n1,2,3\n", "plan.csv: line 2: 3 cells; the first line has 2"},
      {"id,start,duration\n\"1\n2\",2024-01-01,1\n3,never,1\n",
       "plan.csv: line 4, column 'start': 'never': wanted a date YYYY-MM-DD, with a time YYYY-MM-DDTHH:MM"},
      {"id,start,duration\n1,3/4/2024,1\n",
       "plan.csv: line 2, column 'start': '3/4/2024': may be day or month first; write YYYY-MM-DD, or say "
       "--date-order dmy or mdy"},
      {"id,start,duration\n1,2024-01-01,-1\n",
       "plan.csv: line 2, column 'duration': '-1': a duration cannot be negative"},
      {"id,start,duration,type\n1,2024-01-01,1,fly\n",
       "plan.csv: line 2, column 'type': unknown type 'fly' (one of: construct, demolish, temporary, move, "
       "operate, "
       "neutral, appear, drop)"},
      {"id,start,duration,offset\n1,2024-01-01,1,1 2\n",
       "plan.csv: line 2, column 'offset': '1 2': wanted three numbers of metres, x y z with z up, each "
       "within "
       "1000000 (12 0 -3.5)"},
      {"id,start,duration\n,2024-01-01,1\n", "plan.csv: line 2, column 'id': is empty"},
      {"id,start,duration\n1,2024-01-01,1\n1,2024-01-01,1\n",
       "plan.csv: line 3, column 'id': '1' is taken by the task on line 2"},
      {"id,start,duration,parent\n1,2024-01-01,1,9\n",
       "plan.csv: line 2, column 'parent': no task has the id '9'"},
      {"id,start,duration,parent\n1,2024-01-01,1,2\n2,,,1\n", "plan.csv: line 3: task '2' is below itself"},
      {"id,start,duration,predecessors\n1,2024-01-01,1,9FS\n",
       "plan.csv: line 2, column 'predecessors': no task is called '9FS' (a predecessor is an id, alone or "
       "with FS, "
       "SS, FF or SF and a lag: 3FS+2d)"},
      {"id,start,duration,predecessors\nA,2024-01-01,1,\nB,,1,A-2\n",
       "plan.csv: line 3, column 'predecessors': no task is called 'A-2'; a lag stands behind FS, SS, FF or "
       "SF: AFS-2d"},
      {"id,start,duration,predecessors\n1,2024-01-01,1,1SS\n",
       "plan.csv: line 2, column 'predecessors': '1SS': a task cannot be its own predecessor"},
      {"id,start,duration,predecessors\n1,2024-01-01,1,\n2,,1,1FS+2x\n",
       "plan.csv: line 3, column 'predecessors': '2x': wanted a duration: a number of days, or with a unit "
       "w, d, h or "
       "min (5, 2w, 8h, PT8H)"},
      {"id,name,start,duration,predecessors\n1,dig,,1,3\n2,pour,,1,1\n3,,,1,2\n",
       "plan.csv: line 2: tasks wait for each other: '1' ('dig') -> '3' -> '2' ('pour') -> '1' ('dig')"},
      {"id,start,duration\n1,,1\n", "plan.csv: line 2: task '1' has neither a start nor predecessors"},
      {"id,start,duration\n1,2024-01-01,\n",
       "plan.csv: line 2: task '1' has neither a finish nor a duration"},
      {"id,start,finish\n1,2024-03-05,2024-03-01\n",
       "plan.csv: line 2: task '1' finishes (2024-03-02) before it starts (2024-03-05)"},
      {"id,start,duration\n1,9999-12-31,9\n", "plan.csv: line 2: task '1' is not within the years 1 to 9999"},
      {"id,start\r1,2024-01-01\r\r2\r", "plan.csv: line 4: 1 cell; the first line has 2"},
      {"sep=,\r\nid,start\r\n1,2024-01-01\r\n\r\n2\r\n", "plan.csv: line 5: 1 cell; the first line has 2"},
      {"id,name,start\r1,\"two\rlines\",2024-01-01\r2,W\xE4nde,2024-01-01\r",
       "plan.csv: line 4, character 4: byte 0xE4 is no UTF-8; save the plan in UTF-8 (Latin-1 and Windows "
       "code pages are not read)"},
      {std::string("id,start\r1,\0", 12), "plan.csv: line 2: a zero byte; is this a text file?"},
      {"id,start\n1,\"2024\n", "plan.csv: line 2: a quote of this record is not closed"},
      {"id,start\n1,20\"24\n",
       "plan.csv: line 2: a quote in a field that does not begin with one, or text behind a closing quote; a "
       "field "
       "with quotes stands in quotes, and they are doubled"},
      {"id,start\n1,\"2024\"x\n",
       "plan.csv: line 2: a quote in a field that does not begin with one, or text behind a closing quote; a "
       "field "
       "with quotes stands in quotes, and they are doubled"},
      {"id,name,start\n1,ok,2024-01-01\n2,W\xE4nde,2024-01-01\n",
       "plan.csv: line 3, character 4: byte 0xE4 is no UTF-8; save the plan in UTF-8 (Latin-1 and Windows "
       "code pages "
       "are not read)"},
      {std::string("\xFF\xFEi\0d\0", 6), "plan.csv: line 1: is UTF-16; save the plan as CSV in UTF-8"},
      {std::string("id,start\n1,\0", 12), "plan.csv: line 2: a zero byte; is this a text file?"},
      {"sep=|\nid|start\n", "plan.csv: line 1: 'sep=' takes a comma, a semicolon or a tab"},
      {"id,start,duration,parent,predecessors\nS,,,,1FF\n1,2024-01-01,1,,\n2,,1,S,\n",
       "plan.csv: line 2: FF and SF to a summary task do not say when the tasks below it start; give their "
       "dates"},
      {"id,start,finish,predecessors\n1,2024-01-01,2024-01-02,\n2,,2024-01-02,1FF\n",
       "plan.csv: line 3: task '2' has neither a start nor a duration"},
  };
  for (const auto& [text, wanted] : cases) {
    INFO(text);
    CHECK(error_of(text) == wanted);
  }
  std::string wide = "id";
  for (int i = 0; i < 1000; ++i) wide += ",x";
  CHECK(error_of(wide) == "plan.csv: line 1: more than 1000 columns");
  std::string deep = "id,start,duration,parent\n0,2024-01-01,1,\n";
  for (int i = 1; i < 600; ++i) deep += std::to_string(i) + ",,1," + std::to_string(i - 1) + "\n";
  CHECK_THAT(error_of(deep), Catch::Matchers::Contains("tasks are nested deeper than 512"));
}

TEST_CASE("long chains of predecessors do not exhaust the stack") {
  std::string text = "id,start,duration,predecessors\n";
  constexpr int kTasks = 100'000;
  for (int i = 0; i < kTasks; ++i) text += std::to_string(i) + ",,1h," + std::to_string(i + 1) + "\n";
  text += std::to_string(kTasks) + ",2024-01-01,1h,\n";
  const Plan plan = good(text);
  CHECK(*plan.tasks[0].start_s == *plan.tasks[kTasks].start_s + kTasks * CivilSeconds{3600});
}

TEST_CASE("MS Project XML is read by its namespace and needs only UIDs") {
  const Plan plan = good(xml(R"(
    <Task><UID>0</UID><Name>all</Name><OutlineLevel>0</OutlineLevel><Summary>1</Summary></Task>
    <Task><UID>5</UID><ID>1</ID><Name>storey</Name><OutlineLevel>1</OutlineLevel><Summary>1</Summary></Task>
    <Task><UID>2</UID><Name>walls</Name><OutlineLevel>2</OutlineLevel><Start>2024-03-04T08:00:00</Start>
      <Finish>2024-03-08T17:00:00</Finish><Duration>PT40H0M0S</Duration></Task>
    <Task><UID>3</UID><OutlineLevel>2</OutlineLevel><Duration>PT16H0M0S</Duration><DurationFormat>7</DurationFormat>
      <PredecessorLink><PredecessorUID>2</PredecessorUID><Type>3</Type><LinkLag>4800</LinkLag></PredecessorLink></Task>
    <Task><UID>9</UID><IsNull>1</IsNull></Task>
    <Task><UID>4</UID><OutlineLevel>1</OutlineLevel><Milestone>1</Milestone>
      <PredecessorLink><PredecessorUID>5</PredecessorUID></PredecessorLink></Task>
    <Task><UID>6</UID></Task>)"));
  CHECK(dates(plan) ==
        "0 2024-03-04T08:00:00 2024-03-08T17:00:00; 5 2024-03-04T08:00:00 2024-03-08T17:00:00; "
        "2 2024-03-04T08:00:00 2024-03-08T17:00:00; 3 2024-03-05T08:00:00 2024-03-07T08:00:00; "
        "4 2024-03-08T17:00:00 2024-03-08T17:00:00; 6 2024-03-01T08:00:00 2024-03-01T08:00:00");
  CHECK(plan.tasks[0].summary);
  CHECK(plan.tasks[1].summary);
  CHECK_FALSE(plan.tasks[2].summary);
  CHECK(plan.tasks[2].parent == 1);
  CHECK(plan.tasks[2].name == "walls");
  CHECK(plan.tasks[2].where == "plan.csv: line 5: Task with UID 2");
  CHECK(plan.tasks[3].name == "3");
}

TEST_CASE("MS Project XML: elapsed durations are clock time, estimated or not") {
  const auto finish = [](const std::string& format) {
    return dates(
        good(xml("<Task><UID>1</UID><Start>2024-03-04T08:00:00</Start>"
                 "<Duration>PT48H0M0S</Duration><DurationFormat>" +
                 format + "</DurationFormat></Task>")));
  };
  for (const char* const format : {"4", "6", "8", "10", "12", "36", "38", "40", "42", "44"}) {
    INFO(format);
    CHECK(finish(format) == "1 2024-03-04T08:00:00 2024-03-06T08:00:00");
  }
  for (const char* const format : {"3", "5", "7", "9", "11", "21", "35", "37", "39", "41", "43", "53"}) {
    INFO(format);  // of 8 working hours a day
    CHECK(finish(format) == "1 2024-03-04T08:00:00 2024-03-10T08:00:00");
  }
}

TEST_CASE("MS Project XML: prefixes, foreign elements, custom fields, other encodings") {
  const std::string prefixed =
      R"(<p:Project xmlns:p="urn:x" xmlns:q="urn:y"><p:MinutesPerDay>600</p:MinutesPerDay>
    <p:ExtendedAttributes><p:ExtendedAttribute><p:FieldID>188</p:FieldID><p:FieldName>Text1</p:FieldName>
      <p:Alias>Task type</p:Alias></p:ExtendedAttribute><p:ExtendedAttribute><p:FieldID>189</p:FieldID>
      <p:Alias>Objects</p:Alias></p:ExtendedAttribute></p:ExtendedAttributes>
    <p:Tasks><q:Task><q:UID>7</q:UID></q:Task><p:Task><p:UID>1</p:UID><q:Name>no</q:Name><p:Name>W&#228;nde</p:Name>
    <p:Start>2024-03-01T08:00:00</p:Start><p:Duration>PT20H0M0S</p:Duration>
    <p:ExtendedAttribute><p:FieldID>188</p:FieldID><p:Value>Demolish</p:Value></p:ExtendedAttribute>
    <p:ExtendedAttribute><p:FieldID>189</p:FieldID><p:Value>a;b</p:Value></p:ExtendedAttribute>
    </p:Task></p:Tasks></p:Project>)";
  const Plan plan = good(prefixed);
  REQUIRE(plan.tasks.size() == 1);
  CHECK(plan.tasks[0].name == "W\xC3\xA4nde");
  CHECK(plan.tasks[0].profile == Profile::demolish);
  CHECK(plan.tasks[0].objects == std::vector<std::string>{"a", "b"});
  CHECK(dates(plan) == "1 2024-03-01T08:00:00 2024-03-03T08:00:00");

  std::string wide = "\xFF\xFE";  // UTF-16, as MS Project may write it
  for (const char c : xml("<Task><UID>3</UID></Task>").substr(38)) {
    wide += c;
    wide += '\0';
  }
  CHECK(dates(good(wide)) == "3 2024-03-01T08:00:00 2024-03-01T08:00:00");

  const Plan inactive = good(xml(R"(<Task><UID>1</UID><Active>0</Active></Task><Task><UID>2</UID>
    <PredecessorLink><PredecessorUID>1</PredecessorUID></PredecessorLink></Task>)"));
  CHECK(inactive.tasks.size() == 1);
  CHECK(inactive.notes ==
        std::vector<std::string>{"plan.csv: 1 inactive tasks left out, with 1 links to them"});
}

TEST_CASE("MS Project XML that is wrong says where and what") {
  const std::string task = "plan.xml: line 2: Task with UID 1: ";
  const std::map<std::string, std::string> cases{
      {"<Project>\n<Tasks><Task>", "plan.xml: line 2: is not well-formed XML: Start-end tags mismatch"},
      {"<Project", "plan.xml: line 1: is not well-formed XML: Error parsing start element tag"},
      {"\n<Plan/>", "plan.xml: line 2: the root element is 'Plan'; wanted the 'Project' of MS Project XML"},
      {"<Project/>", "plan.xml: has no Task in its Tasks"},
      {xml("<Task xmlns='urn:other'><UID>1</UID></Task>"), "plan.xml: has no Task in its Tasks"},
      {xml("<Task><Name>x</Name></Task>"), "plan.xml: line 2: a Task without a UID"},
      {xml("<Task><UID>x</UID></Task>"), "plan.xml: line 2: a Task: UID 'x' is no whole number of 32 bits"},
      {xml("<Task><UID>1</UID></Task>\n<Task><UID>1</UID></Task>"),
       "plan.xml: line 3: Task with UID 1: its UID is that of a task before (plan.xml: line 2: Task with UID "
       "1)"},
      {xml("<Task><UID>1</UID><Start>soon</Start></Task>"),
       task + "Start 'soon': wanted a date YYYY-MM-DD, with a time YYYY-MM-DDTHH:MM"},
      {xml("<Task><UID>1</UID><Duration>5</Duration><Milestone>maybe</Milestone></Task>"),
       task + "Milestone 'maybe' is none of 0, 1, false, true"},
      {xml("<Task><UID>1</UID><Duration>long</Duration></Task>"),
       task + "Duration 'long': wanted a duration: a number of days, or with a unit w, d, h or min (5, 2w, "
              "8h, PT8H)"},
      {xml("<Task><UID>1</UID><PredecessorLink/></Task>"),
       task + "a PredecessorLink without a PredecessorUID"},
      {xml("<Task><UID>1</UID><PredecessorLink><PredecessorUID>9</PredecessorUID></PredecessorLink></Task>"),
       task + "no task has its PredecessorUID 9"},
      {xml("<Task><UID>1</UID><PredecessorLink><PredecessorUID>1</PredecessorUID></PredecessorLink></Task>"),
       task + "is its own predecessor"},
      {xml("<Task><UID>1</UID><PredecessorLink><PredecessorUID>1</PredecessorUID><Type>4</Type></"
           "PredecessorLink></Task>"),
       task + "PredecessorLink of Type 4; allowed 0 (FF), 1 (FS), 2 (SF), 3 (SS)"},
      {xml("<Task><UID>1</UID></Task>", ""),
       task + "has neither a Start nor a PredecessorLink, and the Project no StartDate"},
      {xml("<Task><UID>1</UID></Task>", "<MinutesPerDay>0</MinutesPerDay>"),
       "plan.xml: line 2: Project: MinutesPerDay goes from 1 to 1440"},
      {xml("<Task><UID>1</UID><PredecessorLink><PredecessorUID>2</PredecessorUID></PredecessorLink></Task>"
           "<Task><UID>2</UID><PredecessorLink><PredecessorUID>1</PredecessorUID></PredecessorLink></Task>"),
       task + "tasks wait for each other: '1' -> '2' -> '1'"},
      {xml("<Task><UID>2</UID></Task><Task><UID>1</UID><PredecessorLink><PredecessorUID>2</PredecessorUID>"
           "<LinkLag>50</LinkLag><LagFormat>19</LagFormat></PredecessorLink></Task>"),
       task + "a lag in percent, and no Start; save the project with its dates"},
  };
  for (const auto& [text, wanted] : cases) {
    INFO(text);
    CHECK(xml_error(text) == wanted);
  }
}

TEST_CASE("a plan that is not there is told as such") {
  const auto plan = read_plan("missing.csv");
  REQUIRE_FALSE(plan);
  CHECK(plan.error().kind == ErrorKind::io);
  CHECK(plan.error().str() == "missing.csv: cannot be read");
}
