// Files whole or not at all: read in one piece; written without a name, flushed, then put in the place of the old one.
// Nothing is overwritten unasked: a screen asks, a verb wants --force. What a thread reads and writes here is seen by
// whoever keeps a record of it, or answered from a record in place of the disc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs {

/// The whole file. A directory, of which files are named, a missing or unreadable file, above 256 MiB: `bad_input`.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path);

/// Where a name leads: the target of a symbolic link, also one that does not exist yet; any other name, and a link that
/// leads nowhere at all (a ring of links), as it is.
[[nodiscard]] std::filesystem::path led_to(const std::filesystem::path& path);

/// Replaces `path` by `content`, which is on disc before. A killed program leaves at most `.NAME.ecs-new`, which the
/// next write removes (more on FAT and NFS, where every file has a name). A link stays one, and its target keeps its
/// mode, or is made; a device or FIFO is written into. `output` problem if not possible.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::string_view content);

/// The name of a file that was written lasts over a loss of power: its folder is on the disc.
[[nodiscard]] Result<void> keep_name(const std::filesystem::path& path);

/// SHA-256 as 64 hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view content);

/// CRC-32 (IEEE 802.3, as zlib and the unit's checksum).
[[nodiscard]] std::uint32_t crc32_of(std::span<const std::uint8_t> bytes);
/// Of two stretches one behind the other, from the CRC of each.
[[nodiscard]] std::uint32_t crc32_of_both(std::uint32_t first, std::uint32_t second, std::size_t second_bytes);

/// Folder for state that outlives a run (the bundled emulator's battery memory, stored links):
/// $ECS_STATE_DIR, else $XDG_STATE_HOME/ecs, else $HOME/.local/state/ecs. Created if missing.
[[nodiscard]] Result<std::filesystem::path> state_folder();

/// From its construction to its end it sees the whole files that this thread reads and writes. One inside another takes
/// its place until it ends.
class FileWatch {
 public:
  FileWatch();
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;
  virtual ~FileWatch();

  /// Of this thread; null: none.
  [[nodiscard]] static FileWatch* current();

  /// It answers in place of the disc: nothing is read from there and nothing written to it.
  [[nodiscard]] virtual bool replaces_disc() const { return false; }
  /// Only where it replaces the disc: the content, or why there is none.
  [[nodiscard]] virtual Result<std::string> content(const std::filesystem::path& path);
  /// Only where it replaces the disc: why it cannot be written there. Otherwise was_written() follows.
  [[nodiscard]] virtual Result<void> may_write(const std::filesystem::path& /*path*/) { return {}; }
  /// Only where it replaces the disc: keep_name().
  [[nodiscard]] virtual Result<void> keeps_name(const std::filesystem::path& /*path*/) { return {}; }

  virtual void was_read(const std::filesystem::path& path, std::string_view content) = 0;
  /// Also what would have been written, where it replaces the disc.
  virtual void was_written(const std::filesystem::path& path, std::string_view content) = 0;

 private:
  FileWatch* before_;
};

/// Nothing of this thread is seen, and all of it comes from the disc, to its end: for keys and tokens.
class Unwatched {
 public:
  Unwatched();
  Unwatched(const Unwatched&) = delete;
  Unwatched& operator=(const Unwatched&) = delete;
  ~Unwatched();

 private:
  FileWatch* before_;
};

/// Whether there is such a file, on the disc or in what replaces it.
[[nodiscard]] bool is_there(const std::filesystem::path& path);

/// At most that many bytes from its beginning, from the disc or from what replaces it; empty where it cannot be read.
/// Not seen by a watch.
[[nodiscard]] std::string head_of(const std::filesystem::path& path, std::size_t bytes);

/// Whether writing to `path` destroys something: a regular file with content, and none of `own`, the files that the
/// same work reads or wrote before and so changes in place.
[[nodiscard]] bool would_overwrite(const std::string& path, const std::vector<std::string>& own = {});

/// A `usage` problem for the first of the files that would be overwritten, unless `force`.
[[nodiscard]] Result<void> spared(const std::vector<std::string>& files, bool force,
                                  const std::vector<std::string>& own = {});
/// The same where nothing can force it. @param instead  what to do: "give another folder"
[[nodiscard]] Result<void> none_there(const std::vector<std::string>& files, std::string_view instead);

/// The disc as it is. A fault is no news: what cannot be asked is not there, what cannot be done is left undone.
namespace disc {

using Path = std::filesystem::path;

[[nodiscard]] bool exists(const Path& path);
[[nodiscard]] bool is_file(const Path& path);
[[nodiscard]] bool is_folder(const Path& path);
[[nodiscard]] Path absolute(const Path& path);  ///< from the working folder; empty without one
bool remove(const Path& path);                  ///< a file or an empty folder. @return whether it was there
void remove_all(const Path& path);
void make_folders(const Path& path);

}  // namespace disc

}  // namespace ecs
