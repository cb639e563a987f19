// `ecs volume` without a terminal: files read, the volume evaluated, its uncertainty.
// Does not live here: the arithmetic (volume/), words, JSON and pictures (view.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "commissioning/session/message.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"
#include "volume/rotary_uncertainty.hpp"

namespace ecs::commissioning {

/// A machine whose volume can be evaluated.
struct PreparedVolume {
  volume::CompensatedMachine machine;
  std::string errors_from;          ///< "the map", "the error model", "the errors file"
  std::string remark;               ///< why the model that was given is not used; empty: none was, or it is
  bool travels_of_machine = false;  ///< false: as far as the map reaches
};

/// @param model  fitted; null: none was given. It is used where it has an effect for all that is compensated
[[nodiscard]] PreparedVolume prepared_volume(const laser::ErrorMap& map, const UnitParameters& parameters,
                                             const std::optional<params::Machine>& machine, const model::Model* model);

/// "X 0 … 1000, Y 0 … 500 mm"
[[nodiscard]] std::string travels_in_words(const volume::Travels& travel_mm);

inline constexpr std::size_t kUsualPlaces = 9261;           ///< 21 on each of three axes
inline constexpr std::size_t kMostPlacesOfModel = 200'000;  ///< a model predicts place by place

/// The plane of the two longest travels; no slice where there is one axis.
inline constexpr const char* kLongestPlane = "longest";

/// As typed; empty: not given.
struct VolumeArguments {
  std::string map, params;
  std::string errors;   ///< errors file of the emulator
  std::string model;    ///< needs the machine
  std::string machine;  ///< default: machine.toml beside the parameters, if it is of the same machine
  bool other_machine = false;
  std::size_t places = kUsualPlaces;
  std::optional<double> tool_length_mm;  ///< along −Z from the point at which the curves were measured
  std::string tool_offset;               ///< "X,Y,Z" [mm]
  std::string rotary;                    ///< errors of the rotary axes of the machine
  std::string at;                        ///< "X,Y,Z" [mm]: one place as well; behind it angles of A, B, C [deg]
  std::string plane;                     ///< "XY", "XZ", "YZ" or kLongestPlane: a slice as well
  bool between = false;                  ///< the largest error between the places as well
  std::string picture, values;           ///< files to write
  volume::UncertaintySettings settings;
  static cli::Fields<VolumeArguments> fields();
};

/// The error at one place, both sides.
struct PlaceAnswer {
  Vector3 position_mm{};
  std::array<Vector3, 2> before_um{};  ///< by side
  std::array<Vector3, 2> after_um{};
  Vector3 standard_uncertainty_um{};                           ///< along X, Y, Z, from the forward side; NaN: not known
  kinematics::Angles angles_deg{};                             ///< of rotary axes
  std::optional<std::array<Vector3, 2>> orientation_um_per_m;  ///< by side; of machines with rotary axes
};

/// A plane of the volume through the place of the largest error before compensation.
struct VolumeSlice {
  std::size_t across = 0, up = 1;  ///< its axes
  volume::Grid grid;               ///< one coordinate of the third axis
  volume::BeforeAfter errors;
};
/// Of these two axes.
[[nodiscard]] Result<VolumeSlice> slice_of(const volume::CompensatedMachine& machine, const Vector3& through_mm,
                                           std::size_t across, std::size_t up, std::size_t columns, std::size_t rows);
/// The axes of the two longest travels, in the order X, Y, Z.
[[nodiscard]] std::array<std::size_t, 2> longest_plane(const volume::CompensatedMachine& machine);
/// The mean of both sides [um].
[[nodiscard]] Vector3 mean_error(const volume::Grid& grid, const volume::VolumeError& error,
                                 const volume::GridIndex& index);

/// Between the places of the grid, on lines through the largest there.
struct LargestBetween {
  volume::ErrorSize before, after;
};

struct ComponentShare {
  Component component = Component::EXX;
  double share = 0.0;  ///< of the variance of the error vector over the volume
  std::string rotary;  ///< an error of a rotary axis in its place: "EXC", "XOC"
};

struct VolumeWork {
  PreparedVolume prepared;
  std::string machine_name;
  volume::VolumeAnswer answer;
  volume::UncertaintyBudget budget;
  volume::RotaryBudget rotary_budget;  ///< of machines with rotary axes
  bool true_rotary = false;            ///< errors of the rotary axes are those of an errors file
  volume::UncertaintySettings settings;
  volume::VolumeUncertainty uncertainty;
  std::vector<ComponentShare> shares;  ///< of the uncertainty, largest first
  std::optional<PlaceAnswer> at;
  std::optional<VolumeSlice> slice;
  std::optional<LargestBetween> between;
  std::vector<std::string_view>
      unmeasured;  ///< neither in the map nor declared zero, and with a lever; of true errors none
  std::vector<std::string> notes;
  std::vector<std::string> inputs;  ///< files that must not be written over
};

/// "C' A' …" and what the unit does about them; empty: the machine has no rotary axes.
[[nodiscard]] std::string rotary_in_words(const VolumeWork& work);

/// Refused: a map of another configuration or machine than the parameters, an axis whose travel nobody states, a place
/// or an angle outside the travels, a model that cannot be used, an errors file that the emulator refuses.
[[nodiscard]] Result<VolumeWork> volume_work(MessageSink& messages, const VolumeArguments& arguments);

// --- looks at a volume, besides its sizes

/// "-100,0,-250" as X, Y, Z. @param option  as problems name it
[[nodiscard]] Result<Vector3> coordinates_in(const std::string& text, std::string_view option);
/// 'A', 'B' or 'C' of 0, 1, 2.
[[nodiscard]] char rotary_letter(std::size_t rotary);
/// The error at the place that `text` says: X, Y, Z and behind them the angles of rotary axes. Refused: outside the
/// travels. @param expected  what is known before the true errors are
[[nodiscard]] Result<void> look_at(const std::string& text, const volume::CompensatedMachine& expected,
                                   VolumeWork& work);
/// The plane ("XY", or kLongestPlane) through the place of the largest error before compensation.
[[nodiscard]] Result<void> cut(const std::string& plane, VolumeWork& work);
/// The largest errors between the places. Refused: rotary axes.
[[nodiscard]] Result<void> look_between(VolumeWork& work);

}  // namespace ecs::commissioning
