// SPDX-License-Identifier: MIT
#pragma once
// Reads the fields of a document strictly: a missing, a mistyped and an unknown field is a DataError that
// names source and path.

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "document/json/json.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/diagnosis_json.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// A value as a message names it: short, whatever it is.
[[nodiscard]] std::string in_words(const Json& value);

/// One object of a document. What is asked for by name must be there and of its kind, but for `find` and
/// `number_if_any`.
class Fields {
  public:
    Fields(const Json& object, std::string source, std::string path);
    [[nodiscard]] const Json& at(std::string_view name);
    [[nodiscard]] const Json* find(std::string_view name);  ///< nullptr where it is absent or null
    [[nodiscard]] bool has(std::string_view name) { return find(name) != nullptr; }
    [[nodiscard]] double number(std::string_view name);
    [[nodiscard]] std::optional<double> number_if_any(std::string_view name);
    [[nodiscard]] std::size_t whole(std::string_view name);  ///< 0 to 1e9
    [[nodiscard]] bool flag(std::string_view name);
    [[nodiscard]] std::string text(std::string_view name);
    [[nodiscard]] std::vector<double> numbers(std::string_view name);
    [[nodiscard]] std::vector<std::string> texts(std::string_view name);
    [[nodiscard]] const Json& list(std::string_view name);
    [[nodiscard]] const Json& list(std::string_view name, std::size_t most);  ///< of so many entries at most
    /// The object of this name; its finish() is the caller's.
    [[nodiscard]] Fields object(std::string_view name);
    /// The value that `value_of` (text to optional) has for the text of this name.
    template <class ValueOf>
    [[nodiscard]] auto named(std::string_view name, ValueOf value_of) {
        const std::string word = text(name);
        const auto value = value_of(word);
        if (!value) refuse_name(name, word);
        return *value;
    }
    /// Calls read(Fields&) with each object of a list of at most so many, and finishes each.
    template <class Read>
    void each(std::string_view name, Read read, std::size_t most = most_entries) {
        const Json& objects = list(name, most);
        for (std::size_t i = 0; i < objects.size(); ++i) {
            Fields entry(objects[i], source_, path_of(fmt::format("{}[{}]", name, i)));
            read(entry);
            entry.finish();
        }
    }
    void ignore(std::initializer_list<std::string_view> names);  ///< known, not used
    void ignore_head();   ///< the same of document_head(), whose kinds are checked
    void finish() const;  ///< throws on fields nobody asked for
    [[nodiscard]] std::string where(std::string_view name) const;  ///< "table.json: bands[2].q"

  private:
    [[nodiscard]] std::string path_of(std::string_view name) const;
    [[noreturn]] void refuse_name(std::string_view name, const std::string& word) const;

    const Json& object_;
    std::string source_, path_;
    std::vector<std::string> seen_;
};

// The account of a recording as every document carries it.

/// Adds "recording", or "recordings" where there are several, and nothing where there is none.
void add_recordings(Json& json, std::span<const Recording> recordings);

/// [{"row", "from_s", "to_s"}]: the listed gaps.
[[nodiscard]] Json gaps_json(const ClockFacts& clock);

// What every document begins with, and the way in of those that are read.

/// {"schema": "ripplenotch/<kind>/1", "tool", "version", "command", "inputs"}: the opening of every document.
[[nodiscard]] Json document_head(std::string_view kind, const Provenance& provenance);

/// Parses a document and checks its schema. Throws DataError with file, line and column of a syntax error,
/// and the schema expected and found.
[[nodiscard]] Json parse_document(std::string_view text, const std::string& source, std::string_view kind);

/// A document of any kind that a command writes: "table", "metrics".
struct AnyDocument {
    std::string kind;
    Json json = Json::object();
};
/// The same for a document of any of these kinds, with a head whose fields are of their types.
[[nodiscard]] AnyDocument parse_any_document(std::string_view text, const std::string& source);

// What was written beside a diagnosis, as its fields.

/// "mjcf" and "plan", where they were asked for.
void put_written(Json& json, const DiagnosisWritten& written);

// What a diagnosis says of the angle of logs without position, in its document.

/// Sets "angle" where a log has no position.
void put_angle(Json& json, const Diagnosis& diagnosis);
void read_angle(Fields& fields, Diagnosis& diagnosis);

}  // namespace ripplenotch
