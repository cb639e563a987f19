// A model of one line of the mill, on the MODEL screen.
#pragma once

#include "app/screens/model/screen.hpp"
#include "tests/screens/support/laser_screen.hpp"
#include "tests/support/screen_driver.hpp"

namespace ecs::app {

inline constexpr const char* kScaleOfX = "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\n";

/// A line of X of the mill, and a model of it.
struct MillModel {
  explicit MillModel(const StateFolder& folder)
      : files{folder.with("model.toml", kScaleOfX),
              {folder.with("EXX.csv", measured_csv(kPositioning, [](double p) { return 0.02 * p; }))},
              "samples/mill/machine.toml",
              {}} {}
  [[nodiscard]] ModelScreen screen(const std::string& link) const {
    return ModelScreen(must(ModelController::open(files, std::make_shared<UnitConnection>(link))));
  }
  ModelArguments files;
};

}  // namespace ecs::app
