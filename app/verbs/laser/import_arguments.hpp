// The options of every verb that reads measurement files.
// Does not live here: what they mean (commissioning/measurements/files.hpp).
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "commissioning/measurements/files.hpp"

namespace ecs::app {

/// Adds --axis --sense --parked --encoding --accept-truncated --table-holds-errors --target-unit --reading-unit
/// --channel, and --columns --skip --rows --delimiter --decimal --values --profile.
void take_import_options(Verb& verb, ImportArguments& arguments);
struct ImportOptions : ImportArguments {
  explicit ImportOptions(Verb& verb) { take_import_options(verb, *this); }
};

/// Reads a file; notes on the console what it was taken for, and what had to be assumed.
[[nodiscard]] Result<laser::Imported> read_with_notes(VerbContext& context, const std::string& file,
                                                      const ImportArguments& arguments);

}  // namespace ecs::app
