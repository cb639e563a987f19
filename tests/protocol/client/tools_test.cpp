// The table of tools replaced as a whole over the link.
#include "protocol/client/client.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

namespace ecs::protocol {

TEST_CASE("a whole table goes as one replacement, with its number of tools and their digest") {
  auto shop = Workshop::on_tcp();
  UnitClient client = shop.client();
  const std::vector<Tool> tools{{9, {0.0, 0.0, -80.12344}}, {3, {1.0, 2.0, 3.0}}};
  REQUIRE(client.replace_tools(tools).has_value());
  ToolTable table;
  for (const Tool& tool : {Tool{3, {1.0, 2.0, 3.0}}, Tool{9, in_tool_steps({0.0, 0.0, -80.1234})}})
    REQUIRE(put_tool(table, tool));
  shop.in_server([&](ModbusServer&, UnitModel& model) {
    CHECK(model.log == std::vector<CommandCode>{CommandCode::begin_tools, CommandCode::stage_tool,
                                                CommandCode::stage_tool, CommandCode::commit_tools});
    CHECK(model.last.length == 2);
    CHECK(model.last.digest == tools_digest(table));
    return true;
  });
}

TEST_CASE("a unit that cannot replace a whole table refuses, and the message says what it can do") {
  auto shop = Workshop::on_tcp();
  shop.in_server([](ModbusServer&, UnitModel& model) { return model.knows_tables = false; });
  UnitClient client = shop.client();
  const std::vector<Tool> tools{{9, {0.0, 0.0, -80.0}}};
  const Problem why = must_fail(client.replace_tools(tools));
  CHECK(why.kind == ProblemKind::refused);
  check_holds(why.message, {"the unit does not know this command; its firmware may be older",
                            "Set its tools one after the other: `ecs utility tool N --offset X,Y,Z`"});
}

}  // namespace ecs::protocol
