// SPDX-License-Identifier: MIT
#pragma once
// A page as a value: the text on some results, before it is rendered as HTML. All text is plain: the renderer
// escapes it.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

struct PageFact {
    std::string name, value;
};

struct PageTable {
    std::string title;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;  ///< as many cells as the header
    bool folded = false;                         ///< shown on demand: a ledger
    std::vector<PageFact> legend = {};           ///< meaning of the labels in the first column
};

/// Good: the data decide. Doubtful: they do not. Bad: a filter amplifies an order.
enum class PageState { none, good, doubtful, bad };

/// One result.
struct PageSection {
    std::string title;            ///< what it is and from which file
    std::string verdict;          ///< one sentence with numbers; may be empty
    std::vector<PageFact> facts;  ///< every single value, shown on demand
    std::vector<Figure> figures;
    std::vector<PageTable> tables;
    std::string command;           ///< the command that makes it again
    std::vector<PageFact> inputs;  ///< name and SHA-256
    std::string json;              ///< the result itself, one object
    bool in_summary = false;       ///< a result; false: a figure alone
    PageState state = PageState::none;
    std::vector<PageFact> key = {};  ///< at most three numbers that answer it
    /// The answer of a whole page: the figures, then the verdict, the tables and the commands.
    bool leads = false;
    std::string about = {};                  ///< below the title
    std::vector<std::string> notes = {};     ///< a list of sentences
    std::vector<std::string> commands = {};  ///< to be pasted, one a line
};

struct Page {
    std::string title;
    std::vector<PageSection> sections;
};

// A page as one self-contained HTML file that makes no network requests.

/// `plotly_js` is the text of that library, which draws the figures; without it gnuplot's pictures take their
/// place; a page without a figure does not hold it. The same page gives the same bytes. Only the scripts that
/// it holds itself may run: its content security policy names them by their hashes and forbids every address.
[[nodiscard]] std::string html_page(const Page& page, const std::optional<std::string>& plotly_js);

/// Text between tags and in attributes.
[[nodiscard]] std::string html_escaped(std::string_view text);

/// A figure for plotly.js 3: {"data": [...], "layout": {...}}, panels one under the other, equal time axes
/// linked; "narrow", where present, lists the values for a phone: {"path", "value"}. Names are escaped for
/// plotly's own markup; the text holds no "<", so that it can be embedded in a page.
[[nodiscard]] std::string plotly_text(const Figure& figure);

// Any result of the tool as a section of a page: its verdict, its numbers, its figures, its tables.

/// `text` is a JSON document with schema ripplenotch/<kind>/1. joint, map, table and figure are read with all
/// their checks; the rounds of a diagnosis become the figure of the gap; everything else in a kind becomes
/// facts (single values), and tables (lists of objects), units taken from the names. Throws DataError for any
/// other document. One section; of a document that lists the results of several joints, one each. The folders
/// of `source` are for messages alone.
[[nodiscard]] std::vector<PageSection> sections_of_result(const std::string& text, const std::string& source);

}  // namespace ripplenotch
