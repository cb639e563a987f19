// DISPLAY DATUM SEQUENCE: the graph of thesis figure 5.5 with cursor and zoom, the events, a second record over it.
#pragma once

#include "app/screens/utility/parts.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/utility/datum_view_controller.hpp"

namespace ecs::app {

class DatumViewScreen final : public Screen {
 public:
  DatumViewScreen() = default;
  /// With a record that was just made.
  explicit DatumViewScreen(DatumRecording recording) { controller_.take(std::move(recording)); }

  [[nodiscard]] std::string title() const override { return "DISPLAY DATUM SEQUENCE"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return controller_.advance(); }
  [[nodiscard]] bool typing() const override { return prompt_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;
  [[nodiscard]] std::string unsaved() const override;

 private:
  enum class Page { graph, events };
  void draw_heading(Canvas& canvas, const Area& area) const;
  void draw_empty(Canvas& canvas, const Area& area) const;
  void draw_events(Canvas& canvas, const Area& area) const;
  void ask_save();
  void ask_file(bool as_overlay);
  [[nodiscard]] bool on_record_key(const Key& key);
  [[nodiscard]] bool on_view_key(const Key& key);

  DatumViewController controller_;
  Page page_ = Page::graph;
  ListPlace event_;
  Prompt prompt_;
  Asking asking_;
  bool sure_to_leave_ = false;
};

}  // namespace ecs::app
