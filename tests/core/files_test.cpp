#include "ripplenotch/core/files.hpp"

#include <unistd.h>

#include <sys/stat.h>

#include <filesystem>
#include <random>

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {
struct Folder {
    fs::path path = fs::temp_directory_path() / ("ripplenotch-files-" + std::to_string(::getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
    [[nodiscard]] std::string file(const char* name) const { return (path / name).string(); }
    [[nodiscard]] std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), {}));
    }
};
}  // namespace

TEST_CASE("a file appears under its name only when it is finished") {
    const Folder folder;
    {
        ByteSink sink(folder.file("a"), ByteSink::Overwrite::no);
        sink.write("half");
        CHECK_FALSE(fs::exists(folder.file("a")));
    }
    CHECK(folder.entries() == 0);
    write_all(folder.file("a"), "whole", ByteSink::Overwrite::no);
    CHECK(read_all(folder.file("a")) == "whole");
    CHECK(folder.entries() == 1);
}

TEST_CASE("nothing is overwritten unasked, not even what appears while writing") {
    const Folder folder;
    write_all(folder.file("a"), "old", ByteSink::Overwrite::no);
    CHECK_THROWS_WITH(write_all(folder.file("a"), "new", ByteSink::Overwrite::no), Contains("--force"));
    CHECK(read_all(folder.file("a")) == "old");
    write_all(folder.file("a"), "new", ByteSink::Overwrite::yes);
    CHECK(read_all(folder.file("a")) == "new");

    ByteSink sink(folder.file("b"), ByteSink::Overwrite::no);
    write_all(folder.file("b"), "someone else's", ByteSink::Overwrite::no);
    CHECK_THROWS_AS(sink.finish(), FileError);
    CHECK(read_all(folder.file("b")) == "someone else's");
    CHECK(folder.entries() == 2);
}

TEST_CASE("bytes of an unfinished file can be rewritten") {
    const Folder folder;
    ByteSink sink(folder.file("a"), ByteSink::Overwrite::no);
    sink.write("0000 rows");
    REQUIRE(sink.can_rewrite());
    sink.rewrite(0, "1234");
    sink.finish();
    CHECK(read_all(folder.file("a")) == "1234 rows");
}

TEST_CASE("pieces of any size follow one another in a file, rewritten or not") {
    const Folder folder;
    std::mt19937_64 random(3);
    std::string all;
    ByteSink sink(folder.file("a"), ByteSink::Overwrite::no);
    sink.expect(1 << 20);
    for (int i = 0; i < 60; ++i) {
        const std::size_t sizes[] = {0, 1, 4095, 65535, 65536, 65537, 131072, random() % 300000};
        const std::string piece(sizes[random() % 8], static_cast<char>('a' + i % 26));
        sink.write(piece);
        all += piece;
        if (i % 20 != 10) continue;
        sink.rewrite(all.size() / 2, "HERE");
        all.replace(all.size() / 2, 4, "HERE");
    }
    sink.finish();
    CHECK(read_all(folder.file("a")) == all);
}

TEST_CASE("room that was reserved and not needed is given back") {
    const Folder folder;
    for (const std::uint64_t expected : {std::uint64_t{0}, std::uint64_t{64} << 20}) {
        const std::string path = folder.file(expected == 0 ? "plain" : "reserved");
        ByteSink sink(path, ByteSink::Overwrite::no);
        sink.expect(expected);
        sink.write(std::string(100000, 'x'));
        sink.finish();
        struct stat status {};
        REQUIRE(::stat(path.c_str(), &status) == 0);
        CHECK(status.st_size == 100000);
        CHECK(status.st_blocks * 512 < 1000000);
    }
}

TEST_CASE("a missing file and a folder are named with the reason") {
    const Folder folder;
    CHECK_THROWS_WITH(read_all(folder.file("none")), Contains("none") && Contains("No such file"));
    CHECK_THROWS_WITH(read_all(folder.path.string()), Contains("is a directory"));
}

TEST_CASE("SHA-256 agrees with the standard's own examples") {
    // FIPS 180-2, appendix B.1 and the empty message.
    Sha256 abc;
    abc.update("a");
    abc.update("bc");
    CHECK(abc.hex() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(Sha256().hex() == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}
