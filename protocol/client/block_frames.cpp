#include "protocol/client/block_frames.hpp"

#include <algorithm>

#include "protocol/client/block_encoder.hpp"
#include "protocol/registers/window_block.hpp"

namespace ecs::protocol {

namespace {

/// Of a frame beside its payload: function 16 and block header 15, reply 8, two silent gaps of 3.5 characters.
constexpr std::size_t kFrameOverhead = 30;

constexpr std::size_t kCodedWindowBytes = kWindowBlocks * kCodedBlockBytes;

/// As many blocks in each frame as there is room for. @pre at most kCodedWindowBytes
WindowFrames coded_window(Address bank, std::span<const std::uint8_t> image, std::size_t from, std::size_t to) {
  WindowFrames window{static_cast<Address>(bank + from), image.subspan(from, to - from), true, {}};
  BitWriter code;
  BlockFrame frame;
  std::size_t count = 0;
  const auto close = [&] {
    frame.number = static_cast<std::uint16_t>(frame.number | (count - 1) << 8);
    frame.payload = code.bytes();
    window.frames.push_back(frame);
  };
  for (std::size_t at = from, block = 0; at < to; at += kCodedBlockBytes, ++block) {
    const std::size_t end = std::min(at + kCodedBlockBytes, to);
    const BitWriter next = coded_block(image, at, end);
    const bool full = count == kCodedBlocksInFrame || code.size() + next.size() > 8 * kBlockBytes;
    if (count > 0 && full) {
      close();
      code = {};
      count = 0;
    }
    if (count == 0) frame = {static_cast<std::uint16_t>(block), 0, {}, 0};
    code.append(next);
    frame.blocks |= std::uint64_t{1} << block;
    frame.bytes += end - at;
    ++count;
  }
  close();
  return window;
}

}  // namespace

WindowFrames plain_window(Address address, std::span<const std::uint8_t> bytes) {
  WindowFrames window{address, bytes, false, {}};
  for (std::size_t at = 0, block = 0; at < bytes.size(); at += kBlockBytes, ++block) {
    const auto part = bytes.subspan(at, std::min(kBlockBytes, bytes.size() - at));
    window.frames.push_back(
        {static_cast<std::uint16_t>(block), std::uint64_t{1} << block, {part.begin(), part.end()}, part.size()});
  }
  return window;
}

std::size_t wire_bytes(const WindowFrames& window) {
  std::size_t bytes = 0;
  for (const BlockFrame& frame : window.frames) bytes += frame.payload.size() + kFrameOverhead;
  return bytes;
}

std::vector<WindowFrames> windows_of(Address bank, std::span<const std::uint8_t> image, std::size_t from,
                                     std::size_t to) {
  std::vector<WindowFrames> windows;
  for (std::size_t at = from; at < to; at += kWindowBytes) {
    const std::size_t end = std::min(at + kWindowBytes, to);
    WindowFrames plain = plain_window(static_cast<Address>(bank + at), image.subspan(at, end - at));
    std::vector<WindowFrames> coded;
    std::size_t bytes = 0;
    for (std::size_t part = at; part < end; part += kCodedWindowBytes) {
      coded.push_back(coded_window(bank, image, part, std::min(part + kCodedWindowBytes, end)));
      bytes += wire_bytes(coded.back());
    }
    if (bytes < wire_bytes(plain))
      windows.insert(windows.end(), coded.begin(), coded.end());
    else
      windows.push_back(std::move(plain));
  }
  return windows;
}

}  // namespace ecs::protocol
