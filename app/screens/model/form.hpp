// Which model, which measurements, which machine: asked before the MODEL screen opens.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/model_session/controller.hpp"

namespace ecs::app {

class ModelForm final : public Screen {
 public:
  [[nodiscard]] std::string title() const override { return "open"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] std::unique_ptr<Screen> opens_by_itself() override;
  [[nodiscard]] bool typing() const override { return !question_; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  void open();
  void start(bool anew);
  [[nodiscard]] ModelArguments files() const;
  void on_field_key(const Key& key);
  std::array<TextLine, 3> fields_;
  int field_ = 0;
  std::string hint_;
  bool problem_ = false;
  std::optional<Question> question_;  ///< whether the model shall be begun in a new file
  mutable int fields_row_ = 0;        ///< of the canvas, as drawn last
  TaskRunner opening_;
  std::unique_ptr<ModelController> ready_;
};

}  // namespace ecs::app
