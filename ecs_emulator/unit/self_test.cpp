#include "ecs_emulator/unit/self_test.hpp"

#include "core/address_map.hpp"

namespace ecs::emulator {
namespace {

ByteView bank_from(const UnitMemory& memory, Address first) { return memory.view(first, bank_bytes(memory.modules())); }

Fault fault_of(ImageFault fault) {
  if (fault == ImageFault::none) return Fault::none;
  return fault == ImageFault::bad_parameters ? Fault::bad_parameters : Fault::block_check;
}

}  // namespace

std::optional<Address> test_axis_memory(UnitMemory& memory) {
  const bool changed = memory.changed();
  for (const Address bank : {kBankA.first, kBankB.first})
    if (const auto failing = failing_address(memory, bank, bank_bytes(memory.modules()))) return failing;
  if (!changed) memory.kept();
  return std::nullopt;
}

std::optional<ActiveImage> active_image(const UnitMemory& memory) {
  const auto commit = active_commit(memory.view(kCommitRecords.first, kCommitRecords.size));
  if (!commit || commit->image_bytes < kPrefixBytes || commit->image_bytes > bank_bytes(memory.modules()))
    return std::nullopt;
  return ActiveImage{*commit, commit->bank == 0 ? kBankA.first : kBankB.first};
}

std::optional<Address> damaged_record(const UnitMemory& memory) {
  const auto slot = damaged_slot(memory.view(kCommitRecords.first, kCommitRecords.size));
  if (!slot) return std::nullopt;
  return kCommitRecords.first + *slot * kCommitSlotBytes;
}

OwnIdentity own_identity_of(const UnitMemory& memory, std::string_view serial_number) {
  const auto active = active_image(memory);
  if (!active) return own_identity(serial_number, {});
  const ByteView image = memory.view(active->first, active->commit.image_bytes);
  return own_identity(serial_number, check_image(image).fault == ImageFault::none ? image : ByteView());
}

Address inactive_bank(const UnitMemory& memory) {
  const auto active = active_image(memory);
  return active && active->first == kBankA.first ? kBankB.first : kBankA.first;
}

bool in_active_bank(const UnitMemory& memory, Address address) {
  const auto active = active_image(memory);
  return active && in_axis_memory(address) && (address >= kBankB.first) == (active->first == kBankB.first);
}

TestVerdict test_map(const UnitMemory& memory, const AxisModules& axis_modules, CompiledMap& map) {
  const auto active = active_image(memory);
  const auto damaged = damaged_record(memory);
  if (!active && damaged) return {Fault::commit_record, *damaged, std::nullopt, 0, 0};
  if (!active) return {Fault::no_map, 0, std::nullopt, 0, 0};
  const ByteView bank = bank_from(memory, active->first);
  const ImageVerdict image = check_image(bank);
  TestVerdict verdict{fault_of(image.fault), active->first, std::nullopt, active->commit.image_check,
                      image.check_found};
  if (verdict.fault != Fault::none) return verdict;
  const ImageView view(bank.first(image.total_bytes));
  if (view.check() != active->commit.image_check) verdict.fault = Fault::block_check;
  if (verdict.fault != Fault::none) return verdict;
  const auto parameters = view.parameters();
  if (!parameters || parameters->memory_modules > memory.modules()) {
    verdict.fault = Fault::bad_parameters;
    return verdict;
  }
  for (const Axis a : kAllAxes) {
    const std::size_t i = index_of(a);
    if (!parameters->axis_present[i] || axis_modules[i] == parameters->axes[i].transducer) continue;
    verdict.fault = Fault::axis_module;
    verdict.axis = a;
    return verdict;
  }
  verdict.fault = compile(view, map).fault;
  return verdict;
}

std::optional<UnitParameters> stored_parameters(const UnitMemory& memory) {
  const auto active = active_image(memory);
  if (!active) return std::nullopt;
  const ByteView bank = bank_from(memory, active->first);
  const ImageVerdict image = check_image(bank);
  if (image.fault != ImageFault::none) return std::nullopt;
  return ImageView(bank.first(image.total_bytes)).parameters();
}

}  // namespace ecs::emulator
