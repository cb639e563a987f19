// The one line to the unit that all screens share.
#include "commissioning/link/unit_connection.hpp"

#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

namespace ecs::commissioning {
namespace {

Result<int> work_on(UnitConnection& connection, int& done) {
  JobControl control;
  return connection.with_link(control, [&](UnitLink& link) -> Result<int> {
    ECS_DO(link.client().output_off());
    return ++done;
  });
}

}  // namespace

TEST_CASE("another unit on the same link is reported before anything is done, and works once it is shown") {
  auto shop = protocol::Workshop::on_tcp();
  UnitConnection connection(protocol::to_text(shop.address()));
  int done = 0;
  REQUIRE(work_on(connection, done));
  CHECK(connection.snapshot().identity->serial_number == "ECS-0042");
  shop.in_server([](protocol::ModbusServer&, protocol::UnitModel& model) { model.serial_number = "OTHER-9"; });
  const auto refused = must_fail(work_on(connection, done));
  CHECK(refused.kind == ProblemKind::refused);
  CHECK(contains(refused.message, "OTHER-9 instead of ECS-0042"));
  CHECK(done == 1);
  CHECK(connection.snapshot().identity->serial_number == "OTHER-9");
  CHECK(work_on(connection, done));
  CHECK(done == 2);
}

TEST_CASE("cancelled work ends soon, and the link serves the next") {
  auto shop = protocol::Workshop::on_tcp();
  UnitConnection connection(protocol::to_text(shop.address()));
  TaskRunner task;
  std::optional<Result<int>> result;
  const auto work = [&connection](JobControl& control) {
    return connection.with_link(control, [](UnitLink& link) -> Result<int> {
      ECS_DO(link.client().test_datum(Axis::X, std::chrono::minutes(1)));
      return 1;
    });
  };
  task.start("testing", work, [&result](Result<int> done) { result = std::move(done); });
  shop.in_server([](protocol::ModbusServer&, protocol::UnitModel& model) { model.busy_polls_left = 1'000'000; });
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  task.cancel();
  for (int k = 0; k < 3000 && !task.advance(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  REQUIRE(result);
  CHECK_FALSE(result->has_value());
  int done = 0;
  CHECK(work_on(connection, done));
}

}  // namespace ecs::commissioning
