// Choosing files: the files used last, a folder's list with what each file is, marks, a path typed with completion.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/ui/widgets.hpp"
#include "commissioning/files/known_files.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {

/// What is to be chosen.
struct FileWish {
  std::vector<FileKind> kinds;  ///< these are offered first, others can be taken as well; empty: any
  bool many = false;            ///< several files at once
  std::string none{};           ///< a row that takes an empty path: "back to the unit"; empty: there is none
  [[nodiscard]] bool has(FileKind kind) const;
};

/// A row of a folder.
struct FolderEntry {
  std::string name;
  bool folder = false;
  bool looked_at = false;
  FileLook look;
};

class FileChooser {
 public:
  FileChooser(const std::filesystem::path& folder, FileWish wish);

  enum class Answer { open, chosen, given_up };
  /// Space marks, Enter opens a folder or takes what is marked, Backspace goes up, letters type a path.
  [[nodiscard]] Answer on_key(const Key& key);
  /// What Enter took: full paths.
  [[nodiscard]] const std::vector<std::string>& taken() const { return taken_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Why what was taken is refused: it stays open.
  void refuse(const std::string& why);

  void draw(Canvas& canvas, const Area& area) const;
  [[nodiscard]] CellPosition cursor(const Area& area) const;
  [[nodiscard]] bool advance() { return looking_.advance(); }
  [[nodiscard]] bool typing() const { return !typed_.text().empty(); }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> keys() const;

 private:
  enum class RowKind { none, up, all, recent, entry, samples };
  struct Row {
    RowKind kind = RowKind::entry;
    std::size_t at = 0;  ///< of the recent files or of the entries
  };
  struct Looked {
    std::map<std::string, FileLook> entries;
    std::vector<std::pair<std::string, FileLook>> recent;  ///< of the kinds that are wished for
  };
  void go(const std::filesystem::path& folder);
  void take(Looked looked);
  void put_wished_first();
  [[nodiscard]] bool wished(const FolderEntry& entry) const;
  [[nodiscard]] std::vector<Row> rows() const;
  [[nodiscard]] std::size_t readable() const;
  [[nodiscard]] int recent_columns(int most) const;
  [[nodiscard]] ListRow picture_of_row(const Row& row, int columns) const;
  [[nodiscard]] std::string folder_shown(int columns) const;
  void mark(const Row& row);
  [[nodiscard]] Answer enter();
  [[nodiscard]] Answer enter_typed();
  [[nodiscard]] Answer taken_now();
  void complete();

  std::filesystem::path folder_;
  FileWish wish_;
  std::vector<FolderEntry> entries_;
  std::vector<std::pair<std::string, FileLook>> recent_;
  std::set<std::string> marked_;  ///< names in this folder, and paths of files used last
  std::vector<std::string> taken_;
  TextLine typed_;
  ListPlace place_;
  bool moved_ = false;  ///< the cursor was moved in this folder
  std::string hint_;
  bool refused_ = false;
  TaskRunner looking_;
  bool look_again_ = false;  ///< the folder changed meanwhile
};

}  // namespace ecs::app
