#include "core/fault.hpp"

#include <array>
#include <cstddef>

#include "base/words.hpp"

namespace ecs {
namespace {

constexpr std::array<FaultText, kFaultCount> kFaults{{
    {"none", "no fault", "no action needed"},
    {"ram_test", "a location of the axis memory does not store the written value",
     "replace the axis memory module that contains the fault address, then send parameters and map again"},
    {"block_check", "the axis memory is corrupt: its checksum (CRC-32) differs from its contents",
     "send parameters and map again; if the fault returns, replace the battery or the memory module"},
    {"no_map", "the axis memory contains no complete error map", "send parameters and map"},
    {"map_not_for_parameters", "the error map lacks a component of this scope, or is for another chain",
     "build the map for the scope and configuration of the parameters, and send both"},
    {"bad_parameters", "a parameter in the axis memory is out of its range",
     "run `ecs params check` and send them again"},
    {"compensation_output", "the compensation output stayed at its limit",
     "check the output scaling factor, the size limit and the map's largest value"},
    {"axis_module", "an axis module, or its transducer's signal, is lost or of the wrong kind",
     "check the transducer cable, the axis module, and the transducer type in the parameters"},
    {"datum_sequence", "the datum sequence did not match the datuming parameters",
     "record the datum sequence and compare it with the datuming parameters"},
    {"loop_overrun", "the compensation loop did not finish within its period", "lengthen the loop iteration time"},
    {"watchdog", "the processor stopped serving the watchdog",
     "switch the unit off and on; if the fault returns, replace the microprocessor module"},
    {"position_jump", "an axis position changed more in one period than any axis can move",
     "check the transducer wiring and the position feedback scaling factor"},
    {"user_software", "the user software ended with an error or exceeded its time",
     "check the program and its start address"},
    {"commit_record", "a commit record in the axis memory is damaged: a map may be lost",
     "send parameters and map again, or compare the unit with its map"},
    {"live_input", "a live input is missing or implausible: its terms are held, then fade out",
     "check the sensor and its cable (`ecs utility inputs`) or the tool (`ecs utility tools`); compensation goes on"},
    {"unknown_input", "the load or the tool is unknown: the output could be wrong beyond the limit",
     "state the load (`ecs utility input load KG`), or select a tool that is in the table (`ecs utility tools`) at the "
     "control or with `ecs utility tool N`; then enter compensation mode again"},
}};

constexpr WordTable<UnitMode, 5> kModes{{"starting", "integration", "datuming", "compensating", "halted"}};
constexpr WordTable<DatumStage, kDatumStageCount> kStages{
    {"waiting", "seeking switch", "on switch", "seeking marker", "done", "failed"}};
constexpr WordTable<DatumFailure, kDatumFailureCount> kFailures{{"none", "wrong initial state", "wrong direction",
                                                                 "too fast", "wrong final state", "no reversal",
                                                                 "no marker", "stopped early"}};
constexpr WordTable<DatumFailure, kDatumFailureCount> kAdvice{
    {"no action needed",
     "move the axis off the reference switch before datuming, or change switch polarity or initial state",
     "change the approach direction, or reference the axis from the other side",
     "lower the reference feed of the controller, or raise the approach speed",
     "change the final state of the switch, or the datum type: the marker came at another point of the sequence",
     "the controller does not turn back off the switch: choose another datum type",
     "check the marker signal of the transducer",
     "choose another datum type: the controller ends its reference motion before this one is complete"}};

}  // namespace

FaultText text_of(Fault fault) noexcept {
  const auto i = static_cast<std::size_t>(fault);
  return i < kFaults.size() ? kFaults[i] : FaultText{"unknown", "a fault unknown to this program", "update ecs"};
}
std::string_view name_of(UnitMode mode) noexcept { return kModes.of(mode); }
std::string_view name_of(DatumStage stage) noexcept { return kStages.of(stage); }
std::string_view name_of(DatumFailure failure) noexcept { return kFailures.of(failure); }
std::string_view advice_for(DatumFailure failure) noexcept { return kAdvice.of(failure); }

}  // namespace ecs
