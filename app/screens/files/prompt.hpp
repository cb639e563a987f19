// A line of text asked for: a number, the name of a new file, what to do; or a file chosen among those that are there:
// the files used last, a folder's list with what each file is, marks, a path typed with completion.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/ui/screen.hpp"
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
  [[nodiscard]] bool is_one_of_all(const FolderEntry& entry) const;
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

class Prompt {
 public:
  enum class Kind {
    number,
    path,  ///< Tab completes it
    text,
  };
  /// Takes what was typed; its answer says why that is refused: the line stays open with it. Empty: taken.
  using Take = std::function<std::string(const std::string&)>;

  /// @param take  returns the refusal, or nothing where all is taken
  template <class F>
  Prompt& ask(std::string label, Kind kind, const std::string& text, F take, std::string hint = {}) {
    begin(std::move(label), kind, text, taking(std::move(take)), std::move(hint));
    return *this;
  }
  /// One file, or several with `wish.many`: `take` is given all of them, or each in turn; it may answer why it refuses
  /// one, which keeps the choice open.
  template <class F>
  void choose(std::string label, FileWish wish, F take) {
    begin_choosing(std::move(label), std::move(wish),
                   [take = std::move(take)](const std::vector<std::string>& paths) -> std::string {
                     std::string refusal;
                     if constexpr (std::is_invocable_r_v<std::string, F, const std::vector<std::string>&>)
                       refusal = take(paths);
                     else if constexpr (std::is_invocable_v<F, const std::vector<std::string>&>)
                       take(paths);
                     else
                       for (const std::string& path : paths)
                         if (refusal.empty()) refusal = taking(take)(path);
                     return refusal;
                   });
  }
  /// What was asked last may be answered with nothing.
  Prompt& or_nothing() {
    may_be_empty_ = true;
    return *this;
  }
  /// Why the text of what was asked last is refused; it stays for correction.
  void refuse(const std::string& why) {
    line_.set(line_.text());
    hint_ = why;
    refused_ = true;
  }
  /// Tab completes what was asked last like this.
  void completed_by(std::function<std::string(const std::string&)> complete) { complete_ = std::move(complete); }
  /// Where choosing begins the next time.
  void begin_in(const std::filesystem::path& folder) { folder_ = folder; }
  [[nodiscard]] bool active() const { return take_ != nullptr || choosing(); }
  [[nodiscard]] bool choosing() const { return chooser_ != nullptr; }
  /// @return whether the key was for it: while it is open, all are
  bool on_key(const Key& key);
  [[nodiscard]] bool advance() { return chooser_ && chooser_->advance(); }
  /// The line in a row of the area; the chooser over all of it.
  void draw(Canvas& canvas, const Area& area, int row) const;
  [[nodiscard]] CellPosition cursor(const Area& area, int row) const;
  [[nodiscard]] std::vector<KeyHelp> keys() const;

 private:
  template <class F>
  static Take taking(F take) {
    if constexpr (std::is_void_v<std::invoke_result_t<F, const std::string&>>)
      return [take = std::move(take)](const std::string& text) {
        take(text);
        return std::string();
      };
    else
      return take;
  }
  void begin(std::string label, Kind kind, const std::string& text, Take take, std::string hint);
  using TakeFiles = std::function<std::string(const std::vector<std::string>&)>;
  void begin_choosing(std::string label, FileWish wish, TakeFiles take);
  void on_chooser_key(const Key& key);
  void give(const std::string& text);
  [[nodiscard]] int columns(const Area& area) const;

  std::string label_;
  Kind kind_ = Kind::number;
  TextLine line_;
  std::string help_;  ///< beside the line
  std::string hint_;  ///< what Tab found, or why the text is refused
  bool refused_ = false;
  std::unique_ptr<FileChooser> chooser_;  ///< null: a line is typed
  std::filesystem::path folder_;          ///< of the file chosen last
  Take take_;
  TakeFiles take_files_;
  bool may_be_empty_ = false;
  std::function<std::string(const std::string&)> complete_;
};

}  // namespace ecs::app
