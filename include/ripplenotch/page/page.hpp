// SPDX-License-Identifier: MIT
#pragma once
// A page as a value: what is said about some results, before anybody turns it into HTML. All text is text:
// whoever renders it escapes it.

#include <string>
#include <vector>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

struct PageFact {
    std::string name, value;
};

/// A cell that leads to another page.
struct PageLink {
    std::size_t row = 0, column = 0;
    std::string address;  ///< with blanks and the like as %20
};

struct PageTable {
    std::string title;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;  ///< as many cells as the header
    bool folded = false;                         ///< shown on demand: a ledger
    std::vector<PageFact> legend = {};           ///< what the labels in the first column stand for
    std::vector<PageLink> links = {};            ///< by row, then by column
};

/// One result.
struct PageSection {
    std::string title;            ///< what it is and of which file
    std::string verdict;          ///< one sentence with numbers; may be empty
    std::vector<PageFact> facts;  ///< every single value, shown on demand
    std::vector<Figure> figures;
    std::vector<PageTable> tables;
    std::string command;             ///< that makes it again
    std::vector<PageFact> inputs;    ///< name and SHA-256
    std::string json;                ///< the result itself, one object
    std::string asked = {};          ///< the question that the result answers; empty: a figure alone
    std::vector<PageFact> key = {};  ///< at most three numbers that answer it
};

struct Page {
    std::string title;
    std::vector<PageSection> sections;
};

}  // namespace ripplenotch
