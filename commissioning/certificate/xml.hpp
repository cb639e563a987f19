// Certificates as XML files: checked against the published schema, and read. The only user of libxml2.
// Nothing is fetched: schemas come from a folder on this computer.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "commissioning/logbook/instrument.hpp"

namespace ecs::commissioning {

/// A folder, with folders in it, that holds dcc.xsd and what it imports (SI_Format.xsd, the signature's schema).
struct SchemaFolder {
  std::filesystem::path folder;
  std::filesystem::path dcc;  ///< the dcc.xsd of the newest version that ECS writes
  std::string version;        ///< "3.3.0", "3.2.1"
};
/// Versions 3.3 and 3.2, the newest first. @param version  only this one; empty: any
[[nodiscard]] Result<SchemaFolder> schema_in(const std::filesystem::path& folder, const std::string& version = {});
/// --schema as given, else $ECS_DCC_SCHEMA; empty: neither.
[[nodiscard]] std::string schema_folder_or_empty(const std::string& given);

/// A `refused` problem with every fault that libxml2 finds, at its line. @param file  name in problems
[[nodiscard]] Result<void> valid_by_schema(std::string_view xml, const SchemaFolder& schema, const std::string& file);

/// What a calibration certificate says of its item: name, maker, serial number, identifier, date. Of DCC 2.4 and later.
[[nodiscard]] Result<Instrument> instrument_in_dcc(std::string_view xml, const std::string& file);

}  // namespace ecs::commissioning
