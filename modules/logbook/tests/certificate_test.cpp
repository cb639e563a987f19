// `ecs log export --dcc` against the published schema.
#include "modules/logbook/certificate.hpp"

#include <cstdlib>

#include "modules/logbook/tests/logbook_folder.hpp"
#include "tests/support/short_lathe.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

/// Five bidirectional runs: ISO 230-2 wants as many.
std::string five_runs() {
  std::string text =
      "# machine: short lathe\n# instrument: XL-80 <laser> & co\n# instrument_serial_number: "
      "L42\naxis,sense,x_mm,reading,approach,run\n";
  for (int run = 1; run <= 5; ++run)
    for (const int approach : {1, -1})
      for (int x = -200; x <= 0; x += 50)
        text += fmt::format("X,EX,{},{},{},{}\n", x, 0.1 * x + approach + 0.1 * run, approach, run);
  return text;
}

struct MeasuredLathe {
  LogbookFolder folder;
  std::string params = folder.with("p.toml", short_lathe("MCM-0107"));
  std::string data = folder.with("exx.csv", five_runs());
  MeasuredLathe() { REQUIRE(ran({"map", "build", data, "--params", params, "-o", folder / "map.csv"}).code == 0); }
  [[nodiscard]] Ran certify(const std::string& file, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{
        "log",   "export", "--dcc", folder / file,           "--json", "--laboratory",     "Lab & Sons", "--customer",
        "Works", "--city", "Town",  "--instrument-um-per-m", "0.5",    "--environment-um", "0.6"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

TEST_CASE("a certificate is valid by the published schema") {
  const char* schema = std::getenv("ECS_DCC_SCHEMA");
  SKIP_UNLESS(schema != nullptr, "ECS_DCC_SCHEMA names no folder with the published schema");
  const MeasuredLathe lathe;
  const Ran unknown = lathe.certify("0.xml");  // with what nobody gave
  CAPTURE(unknown.all());
  REQUIRE(unknown.code == 0);
  const Ran r = lathe.certify("1.xml", {"--all", "--country", "DE"});
  CAPTURE(r.all());
  REQUIRE(r.code == 0);
  CHECK(r.json()["certificate"]["validated"] == true);
  for (const char* version : {"3.3.0", "3.2.1"}) {
    const auto found = schema_in(schema, version);
    if (!found) continue;
    const std::string xml = content_of(lathe.folder / "1.xml");
    if (!contains(xml, fmt::format("schemaVersion=\"{}\"", version))) continue;
    const auto valid = valid_by_schema(xml, *found, "1.xml");
    CHECK_MESSAGE(valid.has_value(), (valid ? std::string() : to_text(valid.error())));
    std::string broken = xml;
    const std::size_t at = broken.find("<dcc:countryCodeISO3166_1>DE<");
    REQUIRE(at != std::string::npos);
    broken.replace(at, 29, "<dcc:countryCodeISO3166_1>Germany<");
    CHECK_FALSE(valid_by_schema(broken, *found, "broken.xml"));
  }
}

}  // namespace
}  // namespace ecs::app
