#pragma once
/// What this program was built from and how. The definitions are written by CMake.

namespace sprung::build {

extern const char* const commit;    ///< full hash, or "unknown"
extern const char* const clean;     ///< "yes", "no" (files differ from the commit) or "unknown"
extern const char* const compiler;  ///< name and version
extern const char* const compiler_flags;
extern const char* const build_type;
extern const char* const project_version;

}  // namespace sprung::build
