// E.C.S. PARAMETERS: the three groups of thesis 5.3 edited in place, checked as one types, compared with file and unit,
// sent, received, saved.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/screens/files/prompt.hpp"
#include "app/screens/parameters/view.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/parameters/controller.hpp"
#include "commissioning/parameters/transfer.hpp"

namespace ecs::app {

class ParametersScreen final : public Screen {
 public:
  explicit ParametersScreen(std::shared_ptr<UnitConnection> line);

  [[nodiscard]] std::string title() const override { return "parameters"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] bool typing() const override;
  [[nodiscard]] CellPosition cursor(const Area& area) const override;
  [[nodiscard]] std::string unsaved() const override;

  [[nodiscard]] const ParametersController& controller() const { return controller_; }
  /// A parameter file, or a machine file to begin new parameters from; a draft that is there is kept.
  void open(const std::string& path, FileKind kind);

 private:
  enum class Page { configuration, compensation, datuming, findings, compare };
  static constexpr int kPages = 5;
  /// A parameter being sought by its name or help.
  struct Seeking {
    TextLine text;
    std::vector<std::string> found;
    int at = 0;
    Page page = Page::configuration;  ///< where one was
    int row = 0;
  };

  // drawing
  void draw_start(Canvas& canvas, const Area& area) const;
  void draw_tabs(Canvas& canvas, const Area& area) const;
  void draw_page(Canvas& canvas, const Area& area) const;
  [[nodiscard]] bool nothing_listed() const;
  void draw_below(Canvas& canvas, const Area& area) const;
  void draw_bottom(Canvas& canvas, const Area& area) const;
  // keys
  [[nodiscard]] Step on_start_key(const Key& key);
  [[nodiscard]] Step on_page_key(const Key& key);
  [[nodiscard]] std::vector<KeyRow> key_table();
  void on_field_key(const Key& key);
  void go_to_finding();
  /// The key under the cursor of the comparison; empty: there is none.
  [[nodiscard]] std::string compared_here() const;
  void take_compared(bool of_file);
  void on_edit_key(const Key& key);
  void on_seek_key(const Key& key);
  void on_click(const Key& key);
  [[nodiscard]] Step leave();
  // what keys do
  void begin_edit();
  void begin_seeking();
  void seek();
  /// @param take  what becomes of it; what it refuses stays open for correction
  void choose_file(const std::string& title, FileWish wish, std::function<Result<void>(const std::string&)> take);
  [[nodiscard]] Result<void> opened(const std::string& path);
  [[nodiscard]] Result<void> begun_from(const std::string& machine);
  void ask_for_file();
  void ask_for_machine();
  void ask_for_check();
  void ask_where_to_save(const std::string& proposed);
  [[nodiscard]] Result<void> save_to(const std::string& path);
  void send();
  void receive();
  void look_again();
  /// Does it at once, or asks first where edits would be lost.
  void unless_lost(const std::string& title, std::function<void()> what);
  void after(const Result<void>& done, const std::string& said);
  void report_undo(const std::string& what, const char* word);
  void go_to(const std::string& key);
  void turn_page(int to);

  [[nodiscard]] bool on_group() const { return page_ <= Page::datuming; }
  [[nodiscard]] std::vector<ParameterRow> rows() const;
  [[nodiscard]] std::string key_here() const;
  [[nodiscard]] ListPlace& place() { return places_[static_cast<std::size_t>(page_)]; }
  [[nodiscard]] const ListPlace& place() const { return places_[static_cast<std::size_t>(page_)]; }
  [[nodiscard]] int page_rows() const;
  void settle_on_field(int direction);

  ParametersController controller_;
  std::optional<Draft> draft_;  ///< offered at the beginning
  ParametersTransfer transfer_;
  std::uint64_t seen_changes_ = 0;  ///< of the link
  Page page_ = Page::configuration;
  std::array<ListPlace, kPages> places_;
  ListPlace start_;
  Message message_;
  std::optional<ValueEdit> edit_;
  Prompt prompt_;
  std::optional<Seeking> seeking_;
  Asking asking_;
  bool leaving_ = false;  ///< the question about it was answered with yes
  mutable CellPosition cursor_{-1, -1};
  mutable Area list_area_;  ///< rows of the list, for clicks and pages
  std::vector<KeyRow> keys_ = key_table();
};

}  // namespace ecs::app
