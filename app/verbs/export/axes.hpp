// How other controls name their axes and count their values, as options of a command line.
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "controllers/siemens.hpp"
#include "controllers/twincat.hpp"

namespace ecs::app {

/// As typed.
struct SiemensArguments {
  std::string axes;  ///< "X=AX1,Y=AX2,Z=AX3"
  int encoder = 0;
  std::string cec_sign = "subtracts";
};

/// Adds --axes, --encoder and --cec-sign.
void take_siemens_arguments(Verb& verb, SiemensArguments& arguments);

/// A `usage` problem names what is wrong with --axes.
[[nodiscard]] Result<controllers::SiemensOptions> siemens_options(const SiemensArguments& arguments);

/// As typed; empty: not given.
struct TwinCatArguments {
  std::string sign;
};

/// Adds --ssfk-sign.
void take_twincat_arguments(Verb& verb, TwinCatArguments& arguments);

/// @param axes  as typed, "X=1,Y=2,Z=3"; empty: these. The same problem.
[[nodiscard]] Result<controllers::TwinCatOptions> twincat_options(const TwinCatArguments& arguments,
                                                                  const std::string& axes);

}  // namespace ecs::app
