// ON LINE MONITOR: what the unit sees of its axes, as it happens.
#pragma once

#include <chrono>
#include <optional>

#include "app/ui/screen.hpp"
#include "app/ui/talk.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/measurements/environment_watch.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/plot/picture_export.hpp"
#include "commissioning/unit/monitor_record.hpp"

namespace ecs::app {

class MonitorScreen final : public Screen {
 public:
  explicit MonitorScreen(std::shared_ptr<UnitConnection> connection)
      : connection_(connection), watching_(std::move(connection)) {}

  [[nodiscard]] std::string title() const override { return "ON LINE MONITOR"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;

 private:
  enum class Strip { position, speed, compensation };
  std::shared_ptr<UnitConnection> connection_;
  UnitConnection::Watching watching_;
  WatchedUnit seen_;
  std::uint64_t changes_ = 0;
  bool frozen_ = false;
  Axis axis_ = Axis::X;
  Strip strip_ = Strip::compensation;
  Message message_;
  std::unique_ptr<EnvironmentWatch> environment_;  ///< null: not asked for
  std::string surroundings_;
  TaskRunner drawing_;
  std::optional<MonitorRecording> recording_;
  std::uint64_t received_ = 0;     ///< samples that the connection had when it was looked at last
  mutable PlotPanel strip_panel_;  ///< as drawn last
  mutable std::chrono::steady_clock::time_point strip_at_{};

  void toggle_recording();
  void record(const WatchedUnit& unit);
  [[nodiscard]] PlotPanel strip_panel() const;
};

/// The picture of one moment. @param age_s  of the newest sample
void draw_monitor(Canvas& canvas, const Area& area, const WatchedUnit& unit, double age_s);

}  // namespace ecs::app
