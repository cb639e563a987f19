// `ecs log export --dcc` and `ecs log instrument`: calibration certificates written, checked and read.
#include <cstdlib>

#include "base/file.hpp"
#include "commissioning/certificate/xml.hpp"
#include "tests/support/logbook_folder.hpp"
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

TEST_CASE("a certificate holds results, uncertainties, the last hash, and from then on the certificate before") {
  const MeasuredLathe lathe;
  const std::string last = ran({"log", "verify", "--json"}).json()["last_hash"];
  const Ran first = lathe.certify("1.xml");
  CAPTURE(first.all());
  REQUIRE(first.code == 0);
  const std::string xml = content_of(lathe.folder / "1.xml");
  CHECK(contains(xml, last));
  CHECK(contains(xml, "bidirectional accuracy of positioning A"));
  CHECK(contains(xml, "<si:unit>\\micro\\metre</si:unit>"));
  CHECK(contains(xml, "<si:coverageFactor>2</si:coverageFactor>"));
  CHECK(contains(xml, "XL-80 &lt;laser&gt; &amp; co"));
  CHECK_FALSE(contains(xml, "previousReport"));
  CHECK(first.json()["certificate"]["sha256"] == sha256_hex(xml));
  CHECK(ran({"log", "list", "--json", "--last", "1"}).json()["entries"][0]["kind"] == "certificate");
  CHECK(lathe.certify("2.xml").code == 1);  // nothing new was measured
  const Ran second = lathe.certify("2.xml", {"--all"});
  REQUIRE(second.code == 0);
  CHECK(contains(content_of(lathe.folder / "2.xml"), sha256_hex(xml)));
  CHECK(second.json()["certificate"]["previous"] == first.json()["certificate"]["identifier"]);
}

/// One line of five bidirectional runs with an instrument of its own.
std::string line_by(const std::string& instrument, const std::string& sense, const std::string& axis,
                    double um_per_mm) {
  std::string text = fmt::format(
      "# machine: short lathe\n# serial_number: MCM-0107\n# date: 2026-03-12\n# instrument: {}\naxis,sense,{},reading,"
      "approach,run\n",
      instrument, axis == "X" ? "x_mm" : "y_mm");
  for (int run = 1; run <= 5; ++run)
    for (const int approach : {1, -1})
      for (int p = -200; p <= 0; p += 50)
        text += fmt::format("{},{},{},{},{},{}\n", axis, sense, p, um_per_mm * p + approach, approach, run);
  return text;
}

/// The part of a certificate about one line.
std::string result_about(const std::string& xml, const std::string& name) {
  const std::size_t at = xml.find(">" + name);
  REQUIRE(at != std::string::npos);
  return xml.substr(at, xml.find("</dcc:measurementResult>", at) - at);
}

TEST_CASE("each line of a certificate has its own instrument, its own names, and no slope of the set-up") {
  const LogbookFolder folder;
  const auto import = [&](const std::string& name, const std::string& content) {
    const Ran r = ran({"laser", "import", folder.with("in/" + name, content), "-o", folder / name});
    REQUIRE_MESSAGE(r.code == 0, r.all());
  };
  import("EXX.csv", line_by("laser", "EX", "X", 0.1));
  import("EYX.csv", line_by("wire", "EY", "X", 0.05));
  import("EBX.csv", line_by("level", "EB", "X", 0.02));
  import("C0Y.csv", line_by("square", "EX", "Y", -0.03));
  const std::string file = folder / "c.xml";
  const Ran r = ran({"log", "export", "--dcc", file, "--instrument-um-per-m", "0.5"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const std::string xml = content_of(file);
  const std::string positioning = result_about(xml, "EXX ("), straightness = result_about(xml, "EYX ("),
                    angle = result_about(xml, "EBX ("), square = result_about(xml, "C0Y (");
  CHECK(contains(positioning, ">laser<"));
  CHECK(contains(straightness, ">wire<"));
  CHECK(contains(angle, ">level<"));
  CHECK(contains(square, ">square<"));
  CHECK(contains(positioning, "bidirectional accuracy of positioning A (ISO 230-2)"));
  CHECK(contains(positioning, "compensation not stated"));
  CHECK(contains(positioning, "<si:coverageFactor>"));
  CHECK(contains(positioning, "Note: targets are evenly spaced"));
  for (const std::string& other : {straightness, angle, square}) {
    CHECK_FALSE(contains(other, "of positioning"));
    CHECK_FALSE(contains(other, "<si:coverageFactor>"));
  }
  // 0.05 um/mm are 50 um/m of set-up; a reversal of 2 um is left, so the means range over 2 um.
  CHECK(contains(straightness, "The slope of the set-up, 50.00 um/m, was removed"));
  CHECK(contains(straightness, "range of the means of both approaches"));
  CHECK_FALSE(contains(angle, "was removed"));
  // E_X along Y of -0.03 um/mm over a square: C0Y = +30 um/m.
  CHECK(contains(square, "squareness C0Y, from the slope of the line"));
  CHECK(contains(square, "<si:value>30</si:value>"));
}

TEST_CASE("what nobody gave is not in a certificate: no country, and the place of work only with a customer") {
  const MeasuredLathe lathe;
  REQUIRE(lathe.certify("1.xml").code == 0);
  const std::string xml = content_of(lathe.folder / "1.xml");
  CHECK(contains(xml, "<dcc:countryCodeISO3166_1>ZZ<"));
  CHECK_FALSE(contains(xml, "<dcc:countryCode>"));
  CHECK(contains(xml, "The country was not given"));
  CHECK(contains(xml, "exx.csv states no date"));
  CHECK(contains(xml, "<dcc:performanceLocation>customer<"));
  REQUIRE(lathe.certify("2.xml", {"--all", "--country", "NO"}).code == 0);
  const std::string other = content_of(lathe.folder / "2.xml");
  CHECK(contains(other, "<dcc:countryCodeISO3166_1>NO<"));
  CHECK(contains(other, "<dcc:countryCode>NO<"));
  CHECK(lathe.certify("3.xml", {"--all", "--country", "no"}).code == 2);
}

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

TEST_CASE("a folder without the schema is refused, and nothing is written") {
  const MeasuredLathe lathe;
  const Ran r = lathe.certify("1.xml", {"--schema", lathe.folder.path.string()});
  CHECK(r.code == 3);
  CHECK_FALSE(std::filesystem::exists(lathe.folder / "1.xml"));
}

TEST_CASE("the laser's own certificate fills the fields of the instrument") {
  const LogbookFolder folder;
  const std::string certificate = folder.with("laser.xml", R"(<?xml version="1.0" encoding="UTF-8"?>
<dcc:digitalCalibrationCertificate xmlns:dcc="https://ptb.de/dcc" schemaVersion="3.3.0">
 <dcc:administrativeData>
  <dcc:coreData><dcc:uniqueIdentifier>C-2026-7</dcc:uniqueIdentifier><dcc:endPerformanceDate>2026-01-10</dcc:endPerformanceDate></dcc:coreData>
  <dcc:items><dcc:item><dcc:name><dcc:content lang="en">laser interferometer</dcc:content></dcc:name>
   <dcc:manufacturer><dcc:name><dcc:content>Acme</dcc:content></dcc:name></dcc:manufacturer>
   <dcc:identifications>
    <dcc:identification><dcc:issuer>owner</dcc:issuer><dcc:value>inventory 5</dcc:value></dcc:identification>
    <dcc:identification><dcc:issuer>manufacturer</dcc:issuer><dcc:value>L42</dcc:value></dcc:identification>
   </dcc:identifications></dcc:item></dcc:items>
 </dcc:administrativeData>
</dcc:digitalCalibrationCertificate>)");
  const Ran r = ran({"log", "instrument", certificate, "--use", "--interval-days", "365", "--json"});
  CAPTURE(r.all());
  REQUIRE(r.code == 0);
  const auto instrument = r.json()["instrument"];
  CHECK(instrument["name"] == "laser interferometer");
  CHECK(instrument["manufacturer"] == "Acme");
  CHECK(instrument["serial_number"] == "L42");
  CHECK(instrument["calibration_certificate"] == "C-2026-7");
  CHECK(instrument["valid_until"] == "2027-01-10");
  CHECK(ran({"log", "instrument", certificate, "--use"}).code == 2);
  const std::string params = folder.with("p.toml", short_lathe(""));
  const std::string data = folder.with("exx.csv", lathe_readings());
  REQUIRE(ran({"map", "build", data, "--params", params, "-o", folder / "map.csv"}).code == 0);
  CHECK(ran({"log", "list", "--json"}).json()["entries"][1]["instrument"]["serial_number"] == "L42");
  CHECK(ran({"log", "instrument", folder.with("page.xml", "<html/>")}).code == 3);
  CHECK(ran({"log", "instrument", folder.with("cut.xml", "<dcc:digital")}).code == 3);
}

}  // namespace
}  // namespace ecs::app
