// A line of text asked for: a number, the name of a new file, what to do; or a file chosen among those that are there.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "app/screens/files/chooser.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"

namespace ecs::app {

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
  void ask(std::string label, Kind kind, const std::string& text, F take, std::string hint = {}) {
    begin(std::move(label), kind, text, taking(std::move(take)), std::move(hint));
  }
  /// One file, or several with `wish.many`: `take` is given all of them, or each in turn; it refuses none.
  template <class F>
  void choose(std::string label, FileWish wish, F take) {
    if constexpr (std::is_invocable_v<F, const std::vector<std::string>&>)
      begin_choosing(std::move(label), std::move(wish), std::move(take));
    else
      begin_choosing(std::move(label), std::move(wish),
                     [take = std::move(take)](const std::vector<std::string>& paths) {
                       for (const std::string& path : paths) take(path);
                     });
  }
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
  using TakeFiles = std::function<void(const std::vector<std::string>&)>;
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
};

}  // namespace ecs::app
