// HTML that cannot be broken by what is put into it, figures in it, and the page of a small commissioning.
#include <cctype>
#include <set>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "commissioning/unit/status.hpp"
#include "modules/report/page.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

/// Two runs each way at 0, 500 and 1000 mm: slope · x, ± reversal/2, and 1 um more or less from run to run.
std::string report_line(const std::string& sense, double slope_um_per_m, double reversal_um, int compensated,
                        const std::string& head = "") {
  std::string text = head + "axis,sense,x_mm,reading,approach,run,compensated\n";
  for (const int run : {1, 2})
    for (const int approach : {1, -1})
      for (const double x : {0.0, 500.0, 1000.0})
        text += fmt::format("X,{},{},{},{},{},{}\n", sense, x,
                            slope_um_per_m * x / 1000.0 + approach * reversal_um / 2.0 + (run == 1 ? 1.0 : -1.0),
                            approach, run, compensated);
  return text;
}

const char* const kReportPlan = R"([[measure]]
name = "EXX"
axis = "X"
sense = "EX"
title = "X positioning"
published_after = 14.0
[[measure]]
name = "EYX"
axis = "X"
sense = "EY"
)";

/// Positioning 36 um/m before and 2 um/m after, straightness flat; a machine of one axis.
struct Commissioning {
  Folder folder;
  std::string page = folder / "report.html";
  explicit Commissioning(const std::string& head = "# machine: bench\n# serial_number: B-1\n# date: 2026-03-01\n",
                         double left_um_per_m = 2.0) {
    (void)folder.with("plan.toml", kReportPlan);
    (void)folder.with("before/EXX.csv", report_line("EX", 36.0, 4.0, 0, head));
    (void)folder.with("after/EXX.csv", report_line("EX", left_um_per_m, 4.0, 1, head));
    (void)folder.with("before/EYX.csv", report_line("EY", 10.0, 2.0, 0, head));
    (void)folder.with("after/EYX.csv", report_line("EY", 0.0, 2.0, 1, head));
  }
  void add_machine() const {
    (void)folder.with("machine.toml",
                      "name = \"bench\"\nconfiguration = \"TXYZ\"\n[axis.X]\ntravel_mm = [0.0, 1000.0]\n");
  }
  /// A map that takes the slope of 36 um/m away, and parameters for it.
  void add_map(const std::string& head = "# machine: bench\n# date: 2026-03-02\n# configuration: TXYZ\n") const {
    (void)ran({"params", "new", "--machine", folder / "machine.toml", "-o", folder / "parameters.toml"});
    (void)folder.with("map.csv", head + "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1000,-36\n");
  }
  [[nodiscard]] Ran report(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"report", folder / "", "-o", page, "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
  [[nodiscard]] std::string html() const { return content_of(page); }
};

/// The first fault of a page: a tag left open or closed without being open, an id given twice, an attribute without
/// quotes. Empty: none.
std::string fault_of(const std::string& html) {
  static const std::set<std::string> kVoid{"meta"};
  std::vector<std::string> open;
  std::set<std::string> ids;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at)) {
    if (html.compare(at, 2, "<!") == 0) {
      ++at;
      continue;
    }
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return "a tag without end";
    std::string tag = html.substr(at + 1, end - at - 1);
    const bool closing = tag.front() == '/', alone = tag.back() == '/';
    std::string name;
    for (std::size_t i = closing ? 1 : 0; i < tag.size() && std::isalnum(static_cast<unsigned char>(tag[i])) != 0; ++i)
      name += tag[i];
    if (name.empty()) return "no name in <" + tag;
    if (const std::size_t id = tag.find(" id=\""); id != std::string::npos)
      if (!ids.insert(tag.substr(id + 5, tag.find('"', id + 5) - id - 5)).second) return "id twice in <" + tag;
    for (std::size_t i = 0; (i = tag.find('=', i)) != std::string::npos;) {
      if (i + 1 >= tag.size() || tag[i + 1] != '"') return "no quotes in <" + tag;
      i = tag.find('"', i + 2);
      if (i == std::string::npos) return "quotes left open in <" + tag;
    }
    if (closing) {
      if (open.empty() || open.back() != name) return "</" + name + "> closes <" + (open.empty() ? "" : open.back());
      open.pop_back();
    } else if (!alone && kVoid.count(name) == 0) {
      open.push_back(name);
    }
    at = name == "style" && !closing ? html.find("</style>", end) : end + 1;
    if (at == std::string::npos) return "style without end";
  }
  return open.empty() ? "" : "<" + open.back() + "> is left open";
}

TEST_CASE("text from a file cannot become markup") {
  CHECK(text("<script>alert(\"1\")</script> & 'x'").html() ==
        "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; &#39;x&#39;");
  CHECK(text("\x1b[31m\xff").html() == "?[31m?");
  CHECK(text("Größe µm").html() == "Größe µm");
  CHECK(element("td", "a<b", "class=\"n\"").html() == "<td class=\"n\">a&lt;b</td>");
}

TEST_CASE("whatever the bytes, text holds no character that opens a tag or ends an attribute") {
  CHECK(rc::check("text is inert", [](const std::string& any) {
    const std::string html = text(any).html();
    RC_ASSERT(html.find_first_of("<>\"'") == std::string::npos);
  }));
}

TEST_CASE("a text in a style sheet ends neither its string nor the style") {
  const std::string css = css_string("mill \"; } </style>");
  CHECK(css.find_first_of("\"<>;}/") == std::string::npos);
  CHECK(css.find("mill \\000022") == 0);
}

TEST_CASE("numbers have a real minus sign, and no zero is negative") {
  CHECK(number_text(-12.345, 1) == "−12.3");
  CHECK(number_text(-0.04, 1) == "0.0");
  CHECK(number_text(-0.05001, 1) == "−0.1");
  CHECK(number_text(std::nan(""), 1) == "–");
  CHECK(quantity_text(12.34, 1, "um/m") == "12.3\u202fµm/m");
  CHECK(plain_number(-4100.0) == "−4100");
  CHECK(plain_number(0.02) == "0.02");
  CHECK(plain_number(-1e-9) == "0");
}

TEST_CASE("small values get the decimals that they need") {
  CHECK(decimals_for(40.0) == 1);
  CHECK(decimals_for(-1.5) == 2);
  CHECK(decimals_for(0.031) == 3);
  CHECK(decimals_for(0.0) == 1);
}

TEST_CASE("units are written as people write them") {
  CHECK(unit_text("um/count") == "µm/count");
  CHECK(unit_text("us") == "µs");
  CHECK(unit_text("um/m2") == "µm/m²");
  CHECK(unit_text("counts/um") == "counts/µm");
  CHECK(unit_text("degC") == "°C");
  CHECK(unit_text("maximum rms_um") == "maximum rms_um");
}

TEST_CASE("a customer's paper names no options and no commands, and keeps the rest of what was said") {
  CHECK(without_commands("the pitch of X is not known, so periodic errors of X were not looked for. Give --machine") ==
        "the pitch of X is not known, so periodic errors of X were not looked for.");
  CHECK(without_commands("EAX is not in the map (--zero EAX=reason), nor is EBX") ==
        "EAX is not in the map, nor is EBX");
  CHECK(without_commands("the map is not complete: `ecs map send` refuses it") == "the map is not complete");
  CHECK(without_commands("A stays. Give --files or `ecs log`. B stays.") == "A stays. B stays.");
  CHECK(without_commands("`ecs params check` says more") == "");
  CHECK(without_commands("from -4 to 3 mm -- a dash, a-b") == "from -4 to 3 mm -- a dash, a-b");
  CHECK(without_commands(std::vector<std::string>{"give --x1 --model", "stays"}) == std::vector<std::string>{"stays"});
}

TEST_CASE("of many rivals a page names five") {
  CHECK(first_few({"a", "b", "c", "d", "e"}) == "a, b, c, d, e");
  CHECK(first_few({"a", "b", "c", "d", "e", "f", "g"}) == "a, b, c, d, e and 2 more");
}

TEST_CASE("ids are unique and plain, whatever the names") {
  std::vector<std::string> used{"map"};
  CHECK(fresh_id("map", used) == "map-2");
  CHECK(fresh_id("map", used) == "map-3");
  CHECK(fresh_id("EXX_z-1000", used) == "EXX-z-1000");
  CHECK(fresh_id("\"><b>", used) == "m---b-");
}

TEST_CASE("a table repeats its head and escapes its cells") {
  TableMarkup table(columns("a<b|>n"));
  table.row({text("<x>"), text("1")});
  const std::string html = table.markup().html();
  check_holds(html, {"<thead><tr><th scope=\"col\">a&lt;b</th><th class=\"n\" scope=\"col\">n</th></tr></thead>",
                     "<td>&lt;x&gt;</td><td class=\"n\">1</td>"});
}

TEST_CASE("ticks are round, evenly spaced and inside the range") {
  CHECK(round_ticks(0.0, 100.0, 5) == std::vector<double>{0.0, 20.0, 40.0, 60.0, 80.0, 100.0});
  CHECK(round_ticks(1.0, 1.0, 5).empty());
  CHECK(round_ticks(1e6, 1e6 + 3e-10, 5).size() <= 16);
  CHECK(round_ticks(-1e308, 1e308, 5).size() <= 16);
  CHECK(rc::check("for any range", [] {
    const double least = *rc::gen::inRange(-100000, 100000) / 7.0;
    const double most = least + *rc::gen::inRange(1, 1000000) / 13.0;
    const auto ticks = round_ticks(least, most, 6);
    RC_ASSERT(ticks.size() >= 2u);
    RC_ASSERT(ticks.size() <= 13u);
    const double step = ticks[1] - ticks[0];
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      RC_ASSERT(ticks[i] >= least - 1e-6 * step);
      RC_ASSERT(ticks[i] <= most + 1e-6 * step);
      if (i > 0) RC_ASSERT(std::abs(ticks[i] - ticks[i - 1] - step) < 1e-6 * step);
    }
  }));
}

TEST_CASE("panels share one scale: the same error stands at the same distance from zero in both") {
  PlotFigure figure{"two", {}, 1, true};
  for (const double last : {100.0, 10.0})
    figure.panels.push_back({"p", "X [mm]", "error", {{"forward", Mark::forward, {{0.0, 0.0}, {1000.0, last}}}}});
  const std::string svg = inline_svg(figure).html();
  // The first line rises by 100 um, the second by 10: a tenth of its height on paper.
  std::vector<double> rises;
  for (std::size_t at = 0; (at = svg.find("class=\"line fwd\" d=\"M", at)) != std::string::npos; ++at) {
    double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;
    if (std::sscanf(svg.c_str() + at + 20, "M%lf %lfL%lf %lf", &x0, &y0, &x1, &y1) == 4) rises.push_back(y0 - y1);
  }
  REQUIRE(rises.size() == 2);
  CHECK(rises[0] == Approx(10.0 * rises[1]).epsilon(0.02));
}

TEST_CASE("the page is complete, needs no other file and runs no script") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  REQUIRE(c.report().code == 0);
  const std::string html = c.html();
  CHECK(fault_of(html) == "");
  for (const char* outside : {"http", "<script", "<link", "src=", "url(", "@import", "<iframe", "onload"})
    CHECK_FALSE(contains(html, outside));
  check_holds(html, {"href=\"#c-EXX\"", "<article id=\"c-EXX\">", "size: A4", "charset=\"utf-8\""});
}

TEST_CASE("the checker of pages finds what it is for") {
  CHECK(fault_of("<p><b>x</p></b>") != "");
  CHECK(fault_of("<p id=\"a\"></p><p id=\"a\"></p>") != "");
  CHECK(fault_of("<p class=n></p>") != "");
  CHECK(fault_of("<p>") != "");
  CHECK(fault_of("<p id=\"a\">x</p><path d=\"M0 0\"/>") == "");
}

TEST_CASE("text from a file is shown, never interpreted") {
  const std::string evil = "</style><script>alert(1)</script>\"'><img src=x onerror=alert(1)>";
  const Commissioning c("# machine: " + evil + "\n# instrument: " + evil + "\n");
  REQUIRE(c.report({"--header", "customer=" + evil, "--date", evil}).code == 0);
  const std::string html = c.html();
  CHECK_FALSE(contains(html, "<script"));
  CHECK_FALSE(contains(html, "<img"));
  CHECK(contains(html, "&lt;script&gt;alert(1)"));
  CHECK(html.find("</style>") == html.rfind("</style>"));
  CHECK(fault_of(html) == "");
}

StatusSnapshot unit_with(std::uint32_t check) {
  StatusSnapshot s;
  s.taken = "2026-05-04T09:30:00Z";
  s.identity.serial_number = "B-1";
  s.identity.axis_present = {true, false, false};
  s.status.mode = UnitMode::integration;
  s.status.fault = Fault::ram_test;
  s.status.fault_address = 0x100ABC;
  s.status.block_check_expected = check;
  s.status.block_check_found = check;
  s.identity_registers = protocol::registers_of(s.identity, 0);
  s.status_registers = protocol::registers_of(s.status, 0);
  s.pointer_registers = protocol::pointer_registers_of(s.status, 0);
  return s;
}

TEST_CASE("the report gives the fault of the unit and whether its map is this one") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  CHECK(c.report({"--json"}).json()["block_check"].is_null());  // the image that a unit holds states its serial number
  REQUIRE(write_snapshot(c.folder / "status.json", unit_with(0)));
  const std::string check = c.report({"--json"}).json()["block_check"];
  const auto number = static_cast<std::uint32_t>(std::stoul(check, nullptr, 16));
  REQUIRE(write_snapshot(c.folder / "status.json", unit_with(number)));
  const Ran r = c.report();
  CHECK(r.code == 0);
  CHECK(contains(r.out, "replace the axis memory module that contains"));
  CHECK(contains(c.html(), "The unit contains this map with these parameters"));
  REQUIRE(write_snapshot(c.folder / "status.json", unit_with(number ^ 1U)));
  REQUIRE(c.report().code == 0);
  CHECK(contains(c.html(), "The unit contained another map or other parameters"));
}

TEST_CASE("with imperial parameters the positions of a report are in inches, and its errors in um") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  REQUIRE(c.report().code == 0);
  check_holds(c.html(), {"X position [mm]", "travel [mm]", "0 … 1000", "from … to [mm]"});
  (void)ran({"params", "set", c.folder / "parameters.toml", "configuration.measurement_system=imperial"});
  REQUIRE(c.report().code == 0);
  check_holds(c.html(), {"X position [in]", "error [µm]", "travel [in]", "0 … 39.37", "from … to [in]"});
  CHECK_FALSE(contains(c.html(), "position [mm]"));
}

}  // namespace
}  // namespace ecs::app
