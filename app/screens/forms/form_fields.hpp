// The fields of a form: the options of a verb with what is typed, files chosen and completed, what is proposed from the
// folder of a model. Does not live here: what is done with them (form_screen.cpp).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/screens/files/prompt.hpp"
#include "app/screens/forms/rows.hpp"
#include "app/ui/widgets.hpp"

namespace ecs::app {

class FormFields {
 public:
  /// Those that the row names first, without the one that its question answers. @param given  filled in before
  FormFields(const FormRow& row, VerbEntry verb, const std::string& link, const FormValues& given);

  [[nodiscard]] const VerbEntry& verb() const { return verb_; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] const VerbOption& option(std::size_t k) const { return verb_.options[k]; }
  [[nodiscard]] std::string text(std::size_t k) const { return values_[k].text(); }
  void set(std::size_t k, const std::string& text) { values_[k].set(text); }
  [[nodiscard]] bool takes(std::string_view option) const;
  [[nodiscard]] bool writes() const;  ///< one of them names a file to write

  [[nodiscard]] FormValues typed() const;
  /// A needed one that is empty; "": none.
  [[nodiscard]] std::string lacking() const;
  /// What nobody has typed is proposed from the folder of the model. @return whether anything was
  bool fill_from_folder();

  /// @param prompt  chooses a file; outlives this  @return what Tab found
  [[nodiscard]] std::string on_key(const Key& key, Prompt& prompt);
  [[nodiscard]] std::string help_here() const;
  void draw(Canvas& canvas, const Area& area) const;
  /// @param area  as drawn
  [[nodiscard]] CellPosition cursor(const Area& area) const;

 private:
  [[nodiscard]] const VerbOption& option() const { return option(static_cast<std::size_t>(place_.selected)); }
  [[nodiscard]] TextLine& value() { return values_[static_cast<std::size_t>(place_.selected)]; }
  [[nodiscard]] int name_columns() const;
  [[nodiscard]] TextLine* field_for(FileKind kind);
  [[nodiscard]] std::string on_tab(Prompt& prompt);
  void choose_file(Prompt& prompt);
  void next_of(const std::vector<std::string>& words, int by);

  VerbEntry verb_;
  std::map<std::string, std::vector<std::string>> offers_;
  std::vector<TextLine> values_;
  ListPlace place_;
};

}  // namespace ecs::app
