// The files of one machine of a fleet: their content as one hash, and their diagnosis.
#pragma once

#include <atomic>
#include <string>

#include "base/result.hpp"
#include "commissioning/fleet/result.hpp"
#include "commissioning/manifest/manifest.hpp"

namespace ecs::commissioning {

/// A row of the manifest; paths are complete.
struct MachineSet {
  std::string id, model, data, machine, type, batch;
};

/// id, model, data; machine, type and batch may be absent.
[[nodiscard]] const ManifestColumns& fleet_columns();
[[nodiscard]] MachineSet machine_set_of(const Manifest& manifest, const ManifestRow& row);

/// SHA-256 of what the answer depends on: model, its map, data, machine, and the number of noise replicates. Where the
/// files lie and what they are called does not matter. Refuses what is no regular file, and more than 8 MiB of data
/// (about 130,000 readings): many such sets at once would not fit into memory.
[[nodiscard]] Result<std::string> content_hash(const MachineSet& set, std::size_t noise_replicates);

/// The diagnosis of `ecs model diagnose` on these files. Safe to call from several threads; the answer does not depend
/// on how many.
/// @param hash  content_hash()  @param cancelled  set by another thread: `refused`, soon
[[nodiscard]] Result<FleetResult> diagnosed(const MachineSet& set, const std::string& hash,
                                            std::size_t noise_replicates, const std::atomic<bool>* cancelled);

}  // namespace ecs::commissioning
