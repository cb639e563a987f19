// RUN USER SOFTWARE: start address, argument and time limit, the regions to choose from, the result with the registers.
#pragma once

#include "app/screens/utility/parts.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/utility/run_controller.hpp"

namespace ecs::app {

class RunScreen final : public Screen {
 public:
  explicit RunScreen(std::shared_ptr<UnitConnection> controller);

  [[nodiscard]] std::string title() const override { return "RUN USER SOFTWARE"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] bool typing() const override { return in_field() && !asking_.active() && !controller_.busy(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  static constexpr int kFields = 3;
  [[nodiscard]] bool in_field() const { return place_ < kFields; }
  void draw_fields(Canvas& canvas, const Area& area) const;
  void draw_regions(Canvas& canvas, const Area& area) const;
  void draw_result(Canvas& canvas, const Area& area) const;
  void enter();

  RunController controller_;
  std::vector<ProgramRegion> regions_ = program_regions();
  std::array<TextLine, kFields> fields_;
  int place_ = 0;  ///< a field, then a region
  Asking asking_;
};

}  // namespace ecs::app
