// SPDX-License-Identifier: MIT
#pragma once
// What every document has in common: how it begins, which logs it is of, and the way out and in.

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "document/archive/json_reader.hpp"
#include "document/archive/json_writer.hpp"
#include "ripplenotch/core/driven_torque.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

void describe(JsonWriter& json, const Gap& gap);
void describe(JsonWriter& json, const DrivenTorque& drive);

/// Adds "recording", or "recordings" where there are several, and nothing where there is none.
void add_recordings(JsonWriter& json, std::span<const Recording> recordings);

/// {"schema": "ripplenotch/<kind>/1", "tool", "version", "command", "inputs"}: the opening of every document.
void add_head(JsonWriter& json, std::string_view kind, const Provenance& provenance);
/// The same of a document that is read: of the right kinds, and not used.
void ignore_head(JsonReader& reader);

/// A document of this kind: its head, and what describe(JsonWriter&, const Result&) says of the result, or
/// what the function adds to a JsonWriter.
template <class Result>
[[nodiscard]] Json document_of(std::string_view kind, const Provenance& provenance, const Result& result) {
    return JsonWriter::object_of([&](JsonWriter& json) {
        add_head(json, kind, provenance);
        if constexpr (std::is_invocable_v<const Result&, JsonWriter&>)
            result(json);
        else
            describe(json, result);
    });
}

/// Parses a document and checks its schema. Throws DataError with file, line and column of a syntax error,
/// and the schema expected and found.
[[nodiscard]] Json parse_document(std::string_view text, const std::string& source, std::string_view kind);

/// Calls read(JsonReader&) with what follows the head of a document. Throws DataError as parse_document()
/// does, and for a field that is missing, mistyped or unknown.
template <class Read>
void read_document(std::string_view text, const std::string& source, std::string_view kind,
                   const Read& read) {
    const Json json = parse_document(text, source, kind);
    JsonReader reader(json, source, "");
    ignore_head(reader);
    read(reader);
    reader.finish();
}

/// The same of a result that is described.
template <class Result>
[[nodiscard]] Result result_of(std::string_view text, const std::string& source, std::string_view kind) {
    Result result;
    read_document(text, source, kind, [&](JsonReader& reader) { describe(reader, result); });
    return result;
}

/// A document of any kind that a command writes: "table", "metrics".
struct AnyDocument {
    std::string kind;
    Json json = Json::object();
};
/// The same for a document of any of these kinds, with a head whose fields are of their types.
[[nodiscard]] AnyDocument parse_any_document(std::string_view text, const std::string& source);

}  // namespace ripplenotch
