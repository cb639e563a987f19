// One step of PROCESS LASER DATA on the screen, and what all steps share: the controller, questions, forms, pictures.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/screens/laser/form.hpp"
#include "app/ui/chart.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/laser_session/controller.hpp"
#include "commissioning/plot/picture_export.hpp"

namespace ecs::app {

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
  /// What a file does not say, field by field. @param field  where to begin; empty: at the first
  void ask_answers(const std::string& path, const std::string& field = {});

  void export_picture(PlotFigure figure, const std::string& stem);

  LaserController controller;

 private:
  friend class LaserScreen;
  Asking asking_;
  std::optional<LaserForm> form_;
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
  [[nodiscard]] virtual bool on_key(const Key& key) = 0;
  [[nodiscard]] virtual std::vector<KeyHelp> keys() const = 0;
  [[nodiscard]] virtual std::string help() const = 0;
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

}  // namespace ecs::app
