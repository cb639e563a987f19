// The options of every verb that reads measurement files.
// Does not live here: what they mean (commissioning/measurements/files.hpp).
#pragma once

#include <string>

#include "app/cli/verb.hpp"
#include "commissioning/measurements/files.hpp"

namespace ecs::app {

/// Adds the options of `laser import`: those that most files need, then the others below headings of their own.
/// @param sense_option  where --sense means something else to the verb
void take_import_options(Verb& verb, ImportArguments& arguments, const std::string& sense_option = "--sense");
struct ImportOptions : ImportArguments {
  explicit ImportOptions(Verb& verb) { take_import_options(verb, *this); }
};
/// The same for work that suits rotary axes too.
struct RotaryImportOptions : ImportOptions {
  explicit RotaryImportOptions(Verb& verb) : ImportOptions(verb) { takes_rotary = true; }
};

/// Reads a file; notes on the console what it was taken for, and what had to be assumed.
[[nodiscard]] Result<laser::Imported> read_with_notes(VerbContext& context, const std::string& file,
                                                      const ImportArguments& arguments);

}  // namespace ecs::app
