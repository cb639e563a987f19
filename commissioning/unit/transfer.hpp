// Parameters and maps between host and unit, what `params send`, `map send`, `batch` and the screens share; and what
// stands between a map and a unit: findings, squareness left behind, another machine, too little memory.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "core/parameters.hpp"
#include "laser/map/error_map.hpp"
#include "params/check.hpp"
#include "params/parameters_toml.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// What to do about a file that is for another machine.
inline constexpr std::string_view kTakeTheRightOne =
    "use the right file, or confirm the other machine with --other-machine";

/// Every objection of findings_for(), and each squareness that the map's header says was measured while the parameters
/// hold 0 (the value lives in the parameters: `map build --params-out` writes it there).
[[nodiscard]] std::vector<std::string> objections_to_map(const laser::ErrorMap& map, const UnitParameters& parameters);

/// Why the map is not for the machine of these parameters: its header and [identity] both name a machine, or both a
/// serial number, and the names differ. What one side does not state is not judged.
[[nodiscard]] std::vector<std::string> other_machine(const laser::MapHeader& header, const params::Identity& identity);

/// The same, worded for somebody who only makes the two files: that they will not be sent together.
[[nodiscard]] std::vector<std::string> made_for_two_machines(const laser::MapHeader& header,
                                                             const params::Identity& identity);

/// The same against the serial number that the unit reports, for a map and for parameters.
[[nodiscard]] std::vector<std::string> other_unit(const laser::MapHeader& header, const std::string& serial_number);
[[nodiscard]] std::vector<std::string> other_unit(const params::Identity& identity, const std::string& serial_number);

/// The same for a dump: the serial number of the unit that it was taken from, and that of the map in its image. A
/// header that cannot be read is an objection too.
/// @param image  sound, of the dump
[[nodiscard]] std::vector<std::string> other_unit(const std::string& dumped_from, std::span<const std::uint8_t> image,
                                                  const std::string& serial_number);

/// Why an image does not fit into a unit: its parameters want more axis memory modules than the unit has, or it holds
/// more values or bytes than they hold. @param image  sound
[[nodiscard]] std::vector<std::string> no_room_for(std::span<const std::uint8_t> image,
                                                   const protocol::Identity& identity);

/// As one `refused` problem about `file` (empty: none); nothing for no objection.
[[nodiscard]] std::optional<Problem> refused_map(const std::vector<std::string>& objections, const std::string& file);

/// The active image of the unit, byte for byte; nothing if it holds none. Refused if another map becomes active
/// meanwhile. Its checksum is not judged here.
[[nodiscard]] Result<std::optional<std::vector<std::uint8_t>>> read_active_image(
    protocol::UnitClient& client, const protocol::ProgressCallback& progress = {});

/// The parameters of the active image, without its tables: a short transfer. Refused if the unit holds none.
[[nodiscard]] Result<UnitParameters> receive_parameters(protocol::UnitClient& client);

/// What is done with the unit's map that does not fit the parameters to send.
enum class UnfitMap {
  refuse,  ///< nothing is sent
  drop,    ///< the parameters are sent without it: the unit does not compensate until a map is sent
};

/// How the refusal begins, by which a screen knows that dropping the map helps.
inline constexpr std::string_view kUnfitMap = "the map in the unit does not fit these parameters",
                                  kNoValidMap = "the unit contains no valid map";

struct SendReport {
  std::size_t bytes = 0;                    ///< of the image that is now active
  std::uint32_t check = 0;                  ///< its checksum
  std::uint32_t commit_sequence = 0;        ///< of the unit, afterwards
  std::size_t bytes_sent = 0;               ///< of the image, what the unit did not hold yet
  bool already_held = false;                ///< this very image was active: nothing was sent or committed
  bool map_kept = false;                    ///< the unit's map stays, with the new parameters
  bool map_dropped = false;                 ///< the unit had a map that is gone
  std::vector<std::string> map_objections;  ///< why it was dropped
  /// The image was made active without a byte sent.
  [[nodiscard]] bool was_in_other_bank() const { return bytes_sent == 0 && !already_held; }
};

/// What is done with a parameter file that does not end with its closing line.
enum class Incomplete { refuse, accept };

/// A parameter file that must not meet a machine, as one `refused` problem with every error; nothing if it may.
[[nodiscard]] std::optional<Problem> objections_to(const params::ParametersFile& file, const std::string& name,
                                                   Incomplete incomplete = Incomplete::refuse);

/// Replaces the unit's parameters and keeps its map, all or nothing (staging, commit).
/// The map is read and judged as `map send` judges one, but not sent again.
/// @param owner  [identity] of the parameters, against the header of that map; empty: not judged
/// @pre objections_to() the file of the parameters are none
[[nodiscard]] Result<SendReport> send_parameters(protocol::UnitClient& client, const UnitParameters& parameters,
                                                 const params::Identity& owner, UnfitMap unfit = UnfitMap::refuse,
                                                 const protocol::ProgressCallback& progress = {});

/// Which tools of the unit's table are beyond the tool range of parameters that are to be sent, in one sentence; empty:
/// none. A table that cannot be read has none.
[[nodiscard]] std::string tools_beyond_range(protocol::UnitClient& client, const UnitParameters& parameters);

/// Whom an image is addressed to when it is sent.
enum class Addressee {
  as_stated,  ///< whom it states; what it leaves open is filled in from the unit
  this_unit,  ///< the unit that answers, with the machine and configuration that it has now (`--other-machine`)
};

/// Why this unit would not take the image, by serial number, machine and configuration. @param image  sound
[[nodiscard]] std::vector<std::string> other_identity(std::span<const std::uint8_t> image,
                                                      const protocol::Identity& unit);

/// The image addressed to this unit. Refused if it is not sound, or `as_stated` where it states another unit, machine
/// or configuration.
[[nodiscard]] Result<std::vector<std::uint8_t>> addressed(std::span<const std::uint8_t> image,
                                                          const protocol::Identity& unit, Addressee addressee);

/// An image that was sent. One that failed may have left either image active: its problem says which.
struct SentImage {
  const protocol::Identity& unit;
  std::span<const std::uint8_t> image;  ///< as it is in the unit when it is active
  const Result<protocol::UploadReport>& sent;
};
/// @param watch  is told of every image that this process sends, whoever asks for it; empty: nobody is. To be set
///               before anything is sent
void watch_sent_images(std::function<void(const SentImage&)> watch);

/// Makes an image active, all or nothing; of it only what the unit does not hold travels. Then the active image is read
/// back: success means that its values are those sent, also where it was held already. Refused, before anything is
/// sent, if the unit is another one or has too little axis memory for it.
[[nodiscard]] Result<SendReport> send_image(protocol::UnitClient& client, std::span<const std::uint8_t> image,
                                            Addressee addressee = Addressee::as_stated,
                                            const protocol::ProgressCallback& progress = {});
/// The same to the unit that has just given this identity.
[[nodiscard]] Result<SendReport> send_image_to(protocol::UnitClient& client, const protocol::Identity& unit,
                                               std::span<const std::uint8_t> image, Addressee addressee,
                                               const protocol::ProgressCallback& progress);

}  // namespace ecs::commissioning
