// A small commissioning in a folder, and the questions that tests ask of a page.
#pragma once

#include <cctype>
#include <set>

#include <fmt/format.h>

#include "tests/support/verb_run.hpp"

namespace ecs::app {

/// Two runs each way at 0, 500 and 1000 mm: slope · x, ± reversal/2, and 1 um more or less from run to run.
inline std::string report_line(const std::string& sense, double slope_um_per_m, double reversal_um, int compensated,
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

inline const char* const kReportPlan = R"([[measure]]
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
inline std::string fault_of(const std::string& html) {
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

}  // namespace ecs::app
