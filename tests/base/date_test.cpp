#include "base/clock.hpp"
#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("a day of the calendar is a date, with or without a time of that day") {
  for (const char* date : {"2026-03-12", "2024-02-29", " 1990-03-12 ", "2024-05-06T09:10", "2024-05-06 09:10:11",
                           "2024-05-06T09:10:11.25Z"})
    CHECK_MESSAGE(is_iso_date(date), date);
}

TEST_CASE("a day that does not exist, or a day followed by other text, is not a date") {
  for (const char* text : {"", "not a date", "2024-05-06N. Comer", "2024-13-01", "2023-02-29", "2024-5-6", "06.05.2024",
                           "2024-05-06T25:00", "2024-05-06 x", "20240506", "2024-05-06T09:10:11.x"})
    CHECK_FALSE_MESSAGE(is_iso_date(text), text);
}

TEST_CASE("a wrong date is reported with what was expected; no date is accepted") {
  CHECK_FALSE(wrong_date(""));
  CHECK_FALSE(wrong_date("2024-05-06"));
  CHECK(wrong_date("not a date") == "expected year-month-day, as in 2026-03-12, found \"not a date\"");
}
