#include "ecs_emulator/unit/processor_library.hpp"

#include <optional>
#include <type_traits>

#include <dlfcn.h>

namespace ecs::emulator {
namespace {

constexpr const char* kSharedObject = "libunicorn.so.2";

std::optional<ProcessorLibrary> loaded() {
  void* const library = ::dlopen(kSharedObject, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return std::nullopt;
  bool whole = true;
  const auto take = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
    whole = whole && function != nullptr;
  };
  ProcessorLibrary functions;
  take(functions.open, "uc_open");
  take(functions.close, "uc_close");
  take(functions.ctl, "uc_ctl");
  take(functions.strerror, "uc_strerror");
  take(functions.reg_read, "uc_reg_read");
  take(functions.reg_write, "uc_reg_write");
  take(functions.mem_read, "uc_mem_read");
  take(functions.mem_write, "uc_mem_write");
  take(functions.mem_map, "uc_mem_map");
  take(functions.mmio_map, "uc_mmio_map");
  take(functions.hook_add, "uc_hook_add");
  take(functions.emu_start, "uc_emu_start");
  take(functions.emu_stop, "uc_emu_stop");
  if (!whole) return std::nullopt;
  return functions;
}

}  // namespace

const ProcessorLibrary* processor_library() {
  static const std::optional<ProcessorLibrary> library = loaded();
  return library ? &*library : nullptr;
}

}  // namespace ecs::emulator
