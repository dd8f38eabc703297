// SPDX-License-Identifier: MIT
#include "log/records/joined_records.hpp"

#include <string>

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("numbers of any size go from distance to distance, and nothing beside them changes", "[log]") {
    for (const std::size_t size : {1U, 2U, 3U, 4U, 8U, 16U}) {
        for (const std::size_t count : {0U, 1U, 7U, 64U}) {
            const std::size_t between = size + 5, offset = 3;
            std::string column(size * count, '\0');
            for (std::size_t i = 0; i < column.size(); ++i) column[i] = static_cast<char>('a' + i % 23);
            std::string records(offset + between * count, '.');
            copy_numbers({column.data(), size}, {records.data() + offset, between}, size, count);
            for (std::size_t i = 0; i < records.size(); ++i) {
                const bool inside = i >= offset && (i - offset) % between < size;
                const std::size_t number = i >= offset ? (i - offset) / between : 0;
                CHECK(records[i] == (inside ? column[number * size + (i - offset) % between] : '.'));
            }
            std::string back(column.size(), '\0');
            copy_numbers({records.data() + offset, between}, {back.data(), size}, size, count);
            CHECK(back == column);
        }
    }
}
