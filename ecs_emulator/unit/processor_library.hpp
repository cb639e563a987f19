// The processor emulation Unicorn (GPL-2), loaded when a program is to run: the emulator works without it and is no
// work derived from it. Does not live here: what a program may touch (user_software.cpp).
#pragma once

#include <unicorn/unicorn.h>

namespace ecs::emulator {

/// Functions of libunicorn by the names of its header, without "uc_".
struct ProcessorLibrary {
  decltype(&uc_open) open = nullptr;
  decltype(&uc_close) close = nullptr;
  decltype(&uc_ctl) ctl = nullptr;
  decltype(&uc_strerror) strerror = nullptr;
  decltype(&uc_reg_read) reg_read = nullptr;
  decltype(&uc_reg_write) reg_write = nullptr;
  decltype(&uc_mem_read) mem_read = nullptr;
  decltype(&uc_mem_write) mem_write = nullptr;
  decltype(&uc_mem_map) mem_map = nullptr;
  decltype(&uc_mmio_map) mmio_map = nullptr;
  decltype(&uc_hook_add) hook_add = nullptr;
  decltype(&uc_emu_start) emu_start = nullptr;
  decltype(&uc_emu_stop) emu_stop = nullptr;
};

/// Null where the library is not installed (Debian: libunicorn2).
[[nodiscard]] const ProcessorLibrary* processor_library();

}  // namespace ecs::emulator
