// The words for what host and unit tell each other.
#include "protocol/registers/unit_data.hpp"

#include <algorithm>

namespace ecs::protocol {

namespace {

constexpr std::array<std::string_view, kUnitErrorCount> kErrorTexts{
    "no error",
    "the unit is not in integration mode; enter integration mode first",
    "no memory at this address; see the address map of the unit",
    "this memory cannot be written by the host",
    "an argument is out of its range",
    "the unit does not know this command; its firmware may be older than this program",
    "nothing is staged; begin staging first",
    "the unit's memory does not hold what was announced; send it again",
    "not a map for this unit",
    "another command is under way; stop it, or wait for its end",
    "the unit has no such axis",
    "the axis is not referenced yet; give it a position or run its datum sequence",
    "a fault of the unit prevents it; see the unit's status",
    "stopped on request",
    "the unit gave up waiting",
    "this transfer has ended: another host has begun one or sent a map, or the unit was restarted; send the map again",
    "the image is not for this unit and its machine",
};

constexpr std::array<std::string_view, kCommandCount> kCommandNames{"none",
                                                                    "enter integration mode",
                                                                    "enter compensation mode",
                                                                    "set axis position",
                                                                    "output compensation",
                                                                    "output off",
                                                                    "begin staging",
                                                                    "commit staged image",
                                                                    "abandon staging",
                                                                    "test datum routine",
                                                                    "record datum",
                                                                    "run user software",
                                                                    "run RAM test",
                                                                    "clear fault",
                                                                    "reset unit",
                                                                    "check memory",
                                                                    "stop"};

}  // namespace

std::size_t Identity::axis_count() const {
  return static_cast<std::size_t>(std::count(axis_present.begin(), axis_present.end(), true));
}

std::string_view text_of(UnitError error) noexcept {
  return kErrorTexts[std::min<std::size_t>(static_cast<std::size_t>(error), kUnitErrorCount - 1)];
}

std::string_view name_of(CommandCode code) noexcept {
  return kCommandNames[std::min<std::size_t>(static_cast<std::size_t>(code), kCommandCount - 1)];
}

}  // namespace ecs::protocol
