// SPDX-License-Identifier: MIT
#include "log/containers/mat_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "log/containers/mat_type.hpp"
#include "log/npy/npy_field.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t text_size = 116, longest_variable = 63;
constexpr std::uint64_t most_mat_rows = (std::uint64_t{1} << 29) - 64;  // of 8 bytes: sizes have 32 bits

constexpr std::uint32_t double_class = 6;

void add_word(std::string& bytes, std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift & 0xffU);
}

// Letters, digits and underscores, a letter first: what MATLAB calls a variable.
std::string variable_name(const std::string& name) {
    std::string plain = name;
    for (char& c : plain)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    if (plain.empty() || std::isalpha(static_cast<unsigned char>(plain.front())) == 0) plain = "x" + plain;
    return plain.substr(0, longest_variable);
}

}  // namespace

void MatTableWriter::begin(std::span<const std::string> names) {
    for (const std::string& name : names) names_.push_back(variable_name(name));
    columns_ = std::vector<TemporaryBytes>(names_.size());
    std::string head = "MATLAB 5.0 MAT-file, written by ripplenotch";
    head.resize(text_size, ' ');
    head.append(8, '\0');
    head += '\0';  // version 1.0, then the byte order
    head += "\x01IM";
    sink_.write(head);
}

void MatTableWriter::rows(std::span<const std::span<const double>> columns) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
        bytes_.resize(8 * columns[c].size());
        NpyField field;
        for (std::size_t r = 0; r < columns[c].size(); ++r, field.offset += 8)
            store_float(bytes_.data(), field, columns[c][r]);
        columns_[c].put(bytes_);
    }
    if (!columns.empty()) rows_ += columns[0].size();
}

void MatTableWriter::write_head(const std::string& name) {
    std::string head;
    const auto add_tag = [&](std::uint32_t type, std::uint64_t size) {
        add_word(head, type);
        add_word(head, static_cast<std::uint32_t>(size));
    };
    add_tag(mat_type::uint32, 8);
    add_word(head, double_class);
    add_word(head, 0);
    add_tag(mat_type::int32, 8);
    add_word(head, static_cast<std::uint32_t>(rows_));
    add_word(head, 1);
    add_tag(mat_type::int8, name.size());
    head += name;
    head.append((8 - name.size() % 8) % 8, '\0');
    add_tag(mat_type::float64, 8 * rows_);
    std::string whole;
    add_word(whole, mat_type::matrix);
    add_word(whole, static_cast<std::uint32_t>(head.size() + 8 * rows_));
    sink_.write(whole + head);
}

void MatTableWriter::end() {
    if (rows_ > most_mat_rows) {
        raise<UsageError>(
            "a MAT file of version 5 holds at most {} rows, and these are {}; write -o NAME.h5 or -o "
            "NAME.npy",
            most_mat_rows, rows_);
    }
    std::vector<char> piece(std::size_t{1} << 20);
    for (std::size_t c = 0; c < names_.size(); ++c) {
        write_head(names_[c]);
        columns_[c].rewind();
        while (const std::size_t got = columns_[c].read(piece.data(), piece.size()))
            sink_.write({piece.data(), got});
    }
}

}  // namespace ripplenotch
