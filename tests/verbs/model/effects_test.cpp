// `ecs model effects`.
#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

TEST_CASE("the library explains every effect and suggests one for a typing error") {
  const nlohmann::json all = ran({"model", "effects", "--json"}).json()["effects"];
  CHECK(all.front()["effect"] == "offset");
  CHECK(all.back()["effect"] == "user");
  const nlohmann::json one = ran({"model", "effects", "cyclic", "--json"}).json();
  check_has(one, {"effect", "title", "cause", "tells_apart", "check", "formula", "parameters", "compensated", "how"});
  CHECK(one["parameters"][0]["name"] == "period_mm");
  CHECK(one["parameters"][0]["unit"] == "mm");
  const Ran wrong = ran({"model", "effects", "backlsh"});
  CHECK(wrong.code == 2);
  CHECK(wrong.messages.find("backlash") != std::string::npos);
  CHECK(widest_line(ran({"model", "effects"}).out) <= 80);
  for (const nlohmann::json& effect : all)
    CHECK(widest_line(ran({"model", "effects", effect["effect"].get<std::string>()}).out) <= 80);
}

}  // namespace
}  // namespace ecs::app
