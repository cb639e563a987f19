// PROCESS LASER DATA: the steps from measured files to a map in the unit, as tabs that say how they stand; one can go
// back to any of them. What all steps share: the controller, questions, forms, charts.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/screens/files/prompt.hpp"
#include "app/screens/laser/mapping.hpp"
#include "app/ui/cells.hpp"
#include "app/ui/chart.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/laser_session/controller.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/plot/picture_export.hpp"

namespace ecs::app {

struct LaserField {
  std::string name;
  std::string help;
  std::string value;
  std::vector<std::string> choices{};  ///< words that are allowed; empty: any text
  bool path = false;                   ///< Tab completes it; where it is empty a file is chosen
  FileWish wish{};                     ///< of a path
};

/// A few fields to fill in, in a box over the screen: typed in place, chosen words on Space, the help of the field
/// under the cursor below.
class LaserForm {
 public:
  /// @param take  the values in the order of the fields; its answer says why they are refused; empty: taken
  using Take = std::function<std::string(const std::vector<std::string>&)>;
  LaserForm(std::string title, std::vector<LaserField> fields, Take take);

  /// Begins at this field rather than at the first.
  void go_to(const std::string& field);
  /// In place of the help of the field, until a key is pressed.
  void say(const std::string& problem);

  /// A box in the middle of `area`.
  void draw(Canvas& canvas, const Area& area) const;
  [[nodiscard]] CellPosition cursor(const Area& area) const;
  /// @return false: the form is done, taken or given up
  [[nodiscard]] bool on_key(const Key& key);
  [[nodiscard]] bool advance() { return files_.advance(); }

 private:
  struct Layout {
    Area box, inside;
    int names = 0, values = 0, fields = 0;
  };
  [[nodiscard]] Layout layout(const Area& area) const;
  void type(const Key& key);
  void next_choice(int by);
  void choose_by_letter(char32_t letter);
  void refuse_word();

  std::string title_;
  std::vector<LaserField> fields_;
  std::vector<TextLine> lines_;
  ListPlace place_;
  Take take_;
  Prompt files_;
  std::string hint_;
  bool refused_ = false;
  std::string word_, before_word_;  ///< letters typed to choose; the value before them
};

/// The import options that the problem of a file asks for: "axis", "sense".
[[nodiscard]] std::vector<std::string> fields_needed(const std::string& problem);
/// What helps as a key of this screen in place of options of a verb.
[[nodiscard]] std::string problem_on_screen(const std::string& problem);
[[nodiscard]] std::string finding_on_screen(std::string message);

/// What of the readings left out is seen: those no farther from the others than the others spread, the rest is beyond.
struct LeftOutSeen {
  std::vector<PlotPoint> inside;
  std::vector<PlotPoint> above;
  std::vector<PlotPoint> below;
  ChartView view;  ///< both ranges stated: room for `inside`, and for marks at the edge
};
/// @pre `left_out` is not empty. @param panel  the readings that count; may be empty: then nothing is far
[[nodiscard]] LeftOutSeen left_out_seen(const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                        const ChartView& view);

/// "beyond the edge: 47.5 um at -200", of many the least and the most; empty: none is.
[[nodiscard]] std::string beyond_text(const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                      std::string_view unit);
/// The legend of the marks: "x left out: 18; beyond the edge: 47.5 um at -200". @pre something is left out
[[nodiscard]] std::string left_out_legend(const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                          std::string_view unit);

/// As draw_chart(), the readings left out as x over it, and under a cursor the means: single runs would not fit. The
/// legend of the marks is left to whoever draws it.
void draw_laser_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                      const ChartView& view);

/// As on_chart_key(); the cursor stops at what is left out as well.
[[nodiscard]] bool on_laser_chart_key(const Key& key, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                      ChartView& view);

/// For pictures: those inside as a series of its own, those beyond named in the title.
[[nodiscard]] PlotPanel with_left_out(PlotPanel panel, const std::vector<PlotPoint>& left_out, std::string_view unit);

/// What a step asks of the screen.
class LaserHost {
 public:
  explicit LaserHost(std::shared_ptr<UnitConnection> unit) : controller(std::move(unit)) {}
  void ask(Question question, std::function<void()> if_yes) {
    asking_.ask(std::move(question), std::move(if_yes), [this] { controller.not_now(); });
  }
  void fill(LaserForm form) { form_.emplace(std::move(form)); }
  /// The parameters file and the scope: asked from several steps.
  void ask_parameters();
  /// What a file does not say: the meaning of its columns where it is a table that no format describes, else field by
  /// field. @param field  where to begin; empty: at the first
  void ask_answers(const std::string& path, const std::string& field = {});
  /// The meaning of the columns of those of these files that no format describes, one after the other.
  void ask_columns(std::vector<std::string> paths);

  /// At once where nothing is replaced by saving, else once that is confirmed.
  void unless_there(std::function<void()> save);
  void export_picture(PlotFigure figure, const std::string& stem);

  LaserController controller;

 private:
  friend class LaserScreen;
  void fill_answers(const std::string& path, const ImportArguments& given, const std::string& field);
  void fill_mapping(MappedTable table, const std::string& field = {});
  void take_mapping(const MappedTable& table);
  /// The form is done: the next file that waits, unless it was cancelled.
  void after_mapping(bool accepted);
  void set_answers(const std::string& path, const ImportArguments& answers);
  Asking asking_;
  std::optional<LaserForm> form_;
  std::optional<MappingForm> mapping_;
  std::vector<std::string> unmapped_;  ///< files whose columns are asked for next
  TaskRunner drawing_;
};

class LaserPage {
 public:
  explicit LaserPage(LaserHost& host) : host_(&host) {}
  virtual ~LaserPage() = default;
  LaserPage(const LaserPage&) = delete;
  LaserPage& operator=(const LaserPage&) = delete;
  virtual void draw(Canvas& canvas, const Area& area) const = 0;
  /// @return whether the key meant something here
  [[nodiscard]] virtual bool on_key(const Key& key) { return act_on(rows_, key); }
  [[nodiscard]] virtual std::vector<KeyHelp> keys() const { return helps_of(rows_); }
  [[nodiscard]] virtual bool advance() { return false; }
  [[nodiscard]] virtual bool typing() const { return false; }
  /// One level back within the step. @return whether there was one
  [[nodiscard]] virtual bool on_escape() { return false; }
  /// Escape, Tab and digits belong to the step now, not to the screen.
  [[nodiscard]] virtual bool holds_keys() const { return false; }
  [[nodiscard]] virtual CellPosition cursor(const Area& /*area*/) const { return {-1, -1}; }

 protected:
  [[nodiscard]] LaserController& controller() const { return host_->controller; }
  [[nodiscard]] LaserHost& host() const { return *host_; }
  std::vector<KeyRow> rows_;  ///< the keys of the step

 private:
  LaserHost* host_;
};

[[nodiscard]] std::unique_ptr<LaserPage> laser_files_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_lines_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_leave_out_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_curves_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_iso_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_map_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_header_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_send_page(LaserHost& host);
[[nodiscard]] std::unique_ptr<LaserPage> laser_verify_page(LaserHost& host);

/// A step: its tab, what it is for in few words and for ?, its page.
struct LaserStepRow {
  const char* name;
  const char* what;
  const char* help;
  std::unique_ptr<LaserPage> (*page)(LaserHost& host);
};
extern const LaserStepRow kLaserStepRows[kLaserSteps];

// --- parts that several steps draw

/// A list at the left and the rest of the room; one above the other where it is narrow; all room for the list where
/// that has fewer than `least_rows`.
struct LaserHalves {
  Area list, rest;
};
[[nodiscard]] LaserHalves laser_halves(const Area& area, int least_rows = 16);
/// One sentence where there is nothing to show yet.
void draw_nothing_yet(Canvas& canvas, const Area& area, const std::string& how_to_get_it);
/// "EXX  Y -1400, Z 0", two columns aligned over all lines.
[[nodiscard]] std::vector<ListRow> rows_of_lines(const LaserWork& work);
/// Keeps a place inside a list that became shorter.
[[nodiscard]] std::size_t place_within(const ListPlace& place, std::size_t count);

class LaserScreen final : public Screen {
 public:
  explicit LaserScreen(std::shared_ptr<UnitConnection> unit);

  [[nodiscard]] std::string title() const override { return "FROM FILES TO THE MAP"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] bool typing() const override { return host_->form_ || host_->mapping_ || page().typing(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;
  [[nodiscard]] std::string unsaved() const override { return host_->controller.unsaved(); }

  [[nodiscard]] LaserController& controller() { return host_->controller; }
  /// Measured files, or one error map; work that is offered is kept for later.
  /// @param parameters  file of the unit's parameters; "" to be chosen
  void open(const std::vector<std::string>& paths, FileKind kind, const std::string& parameters = "");
  [[nodiscard]] LaserStep step() const { return step_; }

 private:
  [[nodiscard]] LaserPage& page() const { return *pages_[static_cast<std::size_t>(step_)]; }
  [[nodiscard]] int message_rows(const Area& area) const;
  [[nodiscard]] Area body_of(const Area& area) const;
  void draw_tabs(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::string bottom_text() const;
  void draw_bottom(Canvas& canvas, const Area& area) const;
  /// Where the tab of a step begins and what stands in it.
  struct Tab {
    int column = 0;
    std::string name;
  };
  [[nodiscard]] std::array<Tab, kLaserSteps> tabs(int columns) const;
  void click(const Key& key);
  [[nodiscard]] bool on_lying_over(const Key& key);
  [[nodiscard]] std::vector<KeyRow> key_table();
  [[nodiscard]] std::vector<KeyRow> offered_table();
  void go(int step);

  std::unique_ptr<LaserHost> host_;
  std::array<std::unique_ptr<LaserPage>, kLaserSteps> pages_;
  LaserStep step_ = LaserStep::files;
  bool leaving_ = false;
  std::vector<KeyRow> keys_ = key_table();              ///< of every step
  std::vector<KeyRow> offered_keys_ = offered_table();  ///< while work of an earlier sitting is offered
  mutable Area drawn_;                                  ///< of the last picture, for clicks
};

}  // namespace ecs::app
