// The MODEL screen: measurements and model side by side, where it fails, what is missing, add it and watch the error
// fall.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "app/screens/files/prompt.hpp"
#include "app/ui/chart.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/model_session/controller.hpp"
#include "commissioning/models/plots.hpp"

namespace ecs::app {

/// What a module adds to the page Next.
struct NextPart {
  std::vector<KeyRow> keys;  ///< there only
  /// In place of the next measurement. False: it has nothing to show yet.
  std::function<bool(Canvas& canvas, const Area& area, const ScrollPlace& scroll)> draw;
  std::string hint;  ///< what can be done there before there is a diagnosis
  std::string help;  ///< sentences for `?`
};
/// Of the modules that are there (app/cli/module.hpp). @param controller, prompt  of the screen; they outlive the parts
[[nodiscard]] std::vector<NextPart> next_parts(ModelController& controller, Prompt& prompt);

class ModelScreen final : public Screen {
 public:
  explicit ModelScreen(std::unique_ptr<ModelController> controller);

  [[nodiscard]] std::string title() const override { return "MODEL"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] std::string unsaved() const override;
  [[nodiscard]] bool typing() const override { return prompt_.active() && !asking_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  enum class Page { curves, fails, causes, ladder, next, after };
  static constexpr int kPages = 6;
  /// The curves of one line as they are shown, made again only when something else is to be seen.
  struct Curves {
    int generation = -1;
    int line = -1;
    ShownReadings shown;
    PlotPanel measured;
    std::vector<PlotPanel> residual;  ///< along the line, then over periods and against other variables
  };

  void draw_tabs(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::string state_text() const;
  [[nodiscard]] int state_rows(const Area& area) const;
  void draw_state(Canvas& canvas, const Area& area) const;
  void draw_curves(Canvas& canvas, const Area& area) const;
  void draw_causes(Canvas& canvas, const Area& area) const;
  void draw_ladder(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::vector<std::string> lines_of_page(int columns) const;
  [[nodiscard]] std::string said_by_parts(std::string NextPart::*what) const;
  [[nodiscard]] bool on_curve_key(const Key& key);
  void turn_page(int by);
  [[nodiscard]] const Curves& curves() const;
  [[nodiscard]] ChartView residual_view() const;
  [[nodiscard]] Step on_question(const Key& key);
  [[nodiscard]] std::vector<KeyRow> key_table();
  void ask_effect();
  void on_page_key(const Key& key);
  [[nodiscard]] bool on_ladder_key(const Key& key);
  [[nodiscard]] bool on_causes_key(const Key& key);
  void add_chosen();
  void ask_to_add_likely(const std::function<void()>& add);
  void begin_map();
  void write_map(const std::string& zero_reason);
  [[nodiscard]] std::vector<std::string> after_lines(int columns) const;
  [[nodiscard]] std::size_t chosen_cause() const;
  [[nodiscard]] std::size_t chosen_effect() const;
  void next_run();

  std::unique_ptr<ModelController> controller_;
  Page page_ = Page::curves;
  int line_ = 0;
  ChartView view_;
  ListPlace cause_;
  enum class Opened { list, details, evidence } opened_ = Opened::list;  ///< of the cause chosen
  ScrollPlace scroll_;
  ShownReadings shown_;
  std::size_t residual_ = 0;                 ///< which panel of the residual
  mutable std::map<int, PlotRange> widest_;  ///< of the residual of each line: its scale stays when it falls
  mutable Curves curves_;
  std::optional<Draft> draft_;  ///< found at the start, not yet decided upon
  bool leaving_ = false;        ///< asked whether the model may stay unsaved
  Prompt prompt_;
  Asking asking_;     ///< before the model is saved, files are overwritten, the map is sent
  ListPlace effect_;  ///< in the list of the page Ladder
  std::vector<NextPart> parts_ = next_parts(*controller_, prompt_);
  std::vector<KeyRow> keys_ = key_table();
};

}  // namespace ecs::app
