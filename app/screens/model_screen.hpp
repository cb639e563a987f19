// The MODEL screen: measurements and model side by side, where it fails, what is missing, add it and watch the error
// fall. Does not live here: its state (model_desk.hpp), curves (chart.hpp).
#pragma once

#include "app/screens/chart.hpp"
#include "app/screens/model_desk.hpp"
#include "app/screens/screen.hpp"
#include "app/screens/widgets.hpp"

namespace ecs::app {

class ModelScreen final : public Screen {
 public:
  explicit ModelScreen(std::unique_ptr<ModelDesk> desk) : desk_(std::move(desk)) {}

  [[nodiscard]] std::string title() const override { return "MODEL"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return desk_->advance(); }
  [[nodiscard]] std::string unsaved() const override;

 private:
  enum class Page { curves, fails, causes, ladder, next };
  static constexpr int kPages = 5;

  void draw_tabs(Canvas& canvas, const Area& area) const;
  void draw_standing(Canvas& canvas, const Area& area) const;
  void draw_curves(Canvas& canvas, const Area& area) const;
  void draw_causes(Canvas& canvas, const Area& area) const;
  void draw_ladder(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::vector<std::string> lines_of_page(int columns) const;
  [[nodiscard]] bool on_curve_key(const Key& key);
  void turn_page(int by);

  std::unique_ptr<ModelDesk> desk_;
  Page page_ = Page::curves;
  int line_ = 0;
  ChartView view_;
  ListPlace cause_;
  ScrollPlace scroll_;
  bool asked_to_leave_ = false;
};

}  // namespace ecs::app
