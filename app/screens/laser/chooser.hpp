// Choosing files: a folder's list with what each file is taken for, marks, a path typed with completion.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "app/ui/widgets.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {

/// A row of a folder.
struct FolderEntry {
  std::string name;
  bool folder = false;
  std::string what;  ///< what it is taken for; empty: not looked at yet
  bool readable = false;
  std::string why_not;  ///< of a file that nothing reads
};

class LaserChooser {
 public:
  explicit LaserChooser(const std::filesystem::path& folder);

  enum class Answer { open, chosen, given_up };
  /// Space marks, Enter opens a folder or takes what is marked, Backspace goes up, letters type a path.
  [[nodiscard]] Answer on_key(const Key& key);
  /// What Enter took: full paths.
  [[nodiscard]] const std::vector<std::string>& taken() const { return taken_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  void draw(Canvas& canvas, const Area& area) const;
  [[nodiscard]] CellPosition cursor(const Area& area) const;
  [[nodiscard]] bool advance() { return looking_.advance(); }
  [[nodiscard]] bool typing() const { return !typed_.text().empty(); }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> keys() const;

 private:
  enum class RowKind { up, all, entry };
  struct Row {
    RowKind kind = RowKind::entry;
    std::size_t entry = 0;
  };
  using Looked = std::map<std::string, FolderEntry>;
  void go(const std::filesystem::path& folder);
  void take(Looked looked);
  [[nodiscard]] std::vector<Row> rows() const;
  [[nodiscard]] std::size_t readable() const;
  [[nodiscard]] ListRow picture_of_row(const Row& row, int columns) const;
  [[nodiscard]] std::string folder_shown(int columns) const;
  void mark(const Row& row);
  [[nodiscard]] Answer enter();
  [[nodiscard]] Answer enter_typed();
  void complete();

  std::filesystem::path folder_;
  std::vector<FolderEntry> entries_;
  std::set<std::string> marked_;  ///< names in this folder
  std::vector<std::string> taken_;
  TextLine typed_;
  ListPlace place_;
  std::string hint_;
  TaskRunner looking_;
  bool look_again_ = false;  ///< the folder changed meanwhile
};

}  // namespace ecs::app
