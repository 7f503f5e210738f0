#include "outcrop/core/file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "core/scratch.h"
#include "outcrop/core/data_path.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::Scratch;

void put(const fs::path& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const Scratch folder;
  {
    OutputFile file(folder / "a.txt");
    file.write("whole");
    EXPECT_FALSE(fs::exists(folder / "a.txt"));
    EXPECT_EQ(file.temporary_path().parent_path(), folder.path());
    EXPECT_EQ(file.temporary_path().extension(), ".txt");
    EXPECT_EQ(file.temporary_path().filename().string().front(), '.');
    file.commit();
    EXPECT_EQ(read_text(folder / "a.txt"), "whole");
  }
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(OutputFile, LeavesTheOldFileAndNothingElseWhenAbandoned) {
  const Scratch folder;
  put(folder / "a.txt", "old");
  OutputFile(folder / "a.txt").write("new");
  EXPECT_EQ(read_text(folder / "a.txt"), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(OutputFile, KeepsWhatWasWrittenAcrossItsBufferAndOverwrites) {
  const Scratch folder;
  std::string expected;
  for (int i = 0; i < 500'000; ++i) expected += std::to_string(i) + " ";
  OutputFile file(folder / "long.bin");
  for (std::size_t at = 0; at < expected.size(); at += 77'777)
    file.write(std::string_view(expected).substr(at, 77'777));
  file.overwrite(2'000'000, std::as_bytes(std::span(std::string_view("count"))));
  expected.replace(2'000'000, 5, "count");
  file.overwrite(0, std::as_bytes(std::span(std::string_view("head"))));
  expected.replace(0, 4, "head");
  file.write("tail");
  file.commit();
  EXPECT_EQ(read_text(folder / "long.bin"), expected + "tail");
}

TEST(OutputFile, LetsALibraryWriteUnderTheTemporaryName) {
  const Scratch folder;
  OutputFile file(folder / "a.txt");
  put(file.temporary_path(), "by a library");
  file.commit();
  EXPECT_EQ(read_text(folder / "a.txt"), "by a library");
}

TEST(OutputFile, RespectsTheUmaskAndFollowsLinks) {
  const Scratch folder;
  fs::create_directory(folder / "real");
  put(folder / "real/a.txt", "old");
  fs::create_symlink("real/a.txt", folder / "link.txt");
  const mode_t before = ::umask(027);
  OutputFile file(folder / "link.txt");
  ::umask(before);
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_text(folder / "real/a.txt"), "new");
  EXPECT_EQ(fs::status(folder / "real/a.txt").permissions(), static_cast<fs::perms>(0640));
}

TEST(OutputFile, KeepsTheOldFileWhenTheDiskIsFull) {
  const Scratch folder;
  put(folder / "a.bin", "old");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{100'000, before.rlim_max};  // stands in for a full disk: write() fails half-way
  ::setrlimit(RLIMIT_FSIZE, &tight);
  const std::string message = message_of<SystemError>([&] {
    OutputFile file(folder / "a.bin");
    file.write(std::string(200'000, 'x'));
    file.commit();
  });
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  EXPECT_NE(message.find("a.bin: cannot be written: "), message.npos) << message;
  EXPECT_EQ(read_text(folder / "a.bin"), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(OutputFile, SaysWhyATargetCannotBe) {
  const Scratch folder;
  put(folder / "file", "");
  const std::string at = folder.path().string();
  const auto refusal = [](const fs::path& target) {
    const std::string checked = message_of<ParameterError>([&] { check_output_path(target); });
    EXPECT_EQ(message_of<ParameterError>([&] { OutputFile file(target); }), checked);
    return checked;
  };
  EXPECT_EQ(refusal(folder / "none/a.ply"),
            at + "/none/a.ply: expected a file in a folder that exists, got no folder " + at + "/none");
  EXPECT_EQ(refusal(folder / "file/a.ply"),
            at + "/file/a.ply: expected a file in a folder, got the file " + at + "/file in its place");
  EXPECT_EQ(refusal(folder.path()), at + ": expected a file to write, got a folder of that name");
  EXPECT_EQ(refusal("/dev/null"), "/dev/null: expected a file to write, got a device, pipe or socket of that name");
  EXPECT_NE(refusal(""), "");
  EXPECT_NE(refusal(folder / ""), "");
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_NO_THROW(check_output_path(folder / "new.ply"));
}

TEST(OutputFile, RefusesAFolderThatIsReadOnly) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write to read-only folders";
  const Scratch folder;
  fs::permissions(folder.path(), static_cast<fs::perms>(0500));
  EXPECT_NE(message_of<ParameterError>([&] { check_output_path(folder / "a.ply"); }).find("Permission denied"),
            std::string::npos);
}

TEST(ReadText, SaysWhatIsWrong) {
  const Scratch folder;
  const std::string at = folder.path().string();
  EXPECT_EQ(message_of<InputError>([&] { (void)read_text(folder / "none"); }),
            at + "/none: expected a readable file, got none");
  EXPECT_EQ(message_of<InputError>([&] { (void)read_text(folder.path()); }),
            at + ": expected a readable file, got a folder");
  put(folder / "empty", "");
  EXPECT_EQ(read_text(folder / "empty"), "");
}

TEST(DataPath, IsTheSourceTreesUnlessTheEnvironmentSaysElse) {
  EXPECT_EQ(data_path(), fs::path(OUTCROP_SOURCE_DIR) / "data");
  const Scratch folder;
  ::setenv("OUTCROP_DATA", folder.path().c_str(), 1);
  EXPECT_EQ(data_path(), folder.path());
  ::setenv("OUTCROP_DATA", (folder / "none").c_str(), 1);
  EXPECT_NE(message_of<InputError>([] { (void)data_path(); }).find("OUTCROP_DATA"), std::string::npos);
  ::unsetenv("OUTCROP_DATA");
}

}  // namespace
}  // namespace outcrop
