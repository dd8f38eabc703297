// SPDX-License-Identifier: MIT
#include "log/messages/cdr_program.hpp"

#include "log/messages/cdr_cursor.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

void pass_cdr(CdrCursor& cursor, const std::vector<CdrStep>& steps) {
    for (const CdrStep& step : steps) pass_cdr(cursor, step);
}
void pass_cdr(CdrCursor& cursor, const CdrStep& step) {
    switch (step.kind) {
        case CdrStep::Kind::number:
            cursor.take(step.size);
            break;
        case CdrStep::Kind::stamp:
            cursor.take(4, 2);
            break;
        case CdrStep::Kind::skip:
            if (step.count > 0) cursor.take(step.size, step.count);
            break;
        case CdrStep::Kind::skip_any:
            if (const std::uint32_t count = cursor.length(); count > 0) cursor.take(step.size, count);
            break;
        case CdrStep::Kind::text:
            cursor.text();
            break;
        case CdrStep::Kind::texts:
            for (std::uint32_t left = cursor.list_length(); left > 0; --left) cursor.text();
            break;
        case CdrStep::Kind::text_is:
            if (const std::string_view text = cursor.text(); text != step.expected)
                raise<DataError>(
                    "'{}' as {}, expected '{}' as in the first message; record the joints on topics of their "
                    "own",
                    text.substr(0, 60), step.path, step.expected);
            break;
        case CdrStep::Kind::length_is:
            if (const std::uint32_t count = cursor.length(); count != step.count)
                raise<DataError>(
                    "{} elements of {}, expected {} as in the first message; record messages of one shape on "
                    "a topic",
                    count, step.path, step.count);
            break;
        case CdrStep::Kind::repeat_any:
            for (std::uint32_t left = cursor.list_length(); left > 0; --left) pass_cdr(cursor, step.inner);
            break;
    }
}

void run_cdr(std::span<const CdrStep> steps, std::string_view message,
             const std::vector<std::ptrdiff_t>& offsets, char* into) {
    CdrCursor cursor(message);
    for (const CdrStep& step : steps) {
        const bool keeps = step.kind == CdrStep::Kind::number || step.kind == CdrStep::Kind::stamp;
        if (!keeps || offsets[step.leaf] < 0) {
            pass_cdr(cursor, step);
        } else if (step.kind == CdrStep::Kind::number) {
            cursor.number(step.size, into + offsets[step.leaf]);
        } else {
            const std::int64_t stamp = cursor.stamp();
            std::memcpy(into + offsets[step.leaf], &stamp, sizeof stamp);
        }
    }
}

}  // namespace ripplenotch
