#pragma once
// toml++ as a header, with errors as values. The package's CMake target selects its shared library instead, which
// throws and carries no version: a program built here must not depend on it.
#ifdef TOML_HEADER_ONLY
#undef TOML_HEADER_ONLY
#endif
#ifdef TOML_SHARED_LIB
#undef TOML_SHARED_LIB
#endif
#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0
#define TOML_ENABLE_FORMATTERS 0

// Some of its assertions fail on files that are no TOML ("[.]", "x = [}"), which it goes on to refuse as it should.
// With NDEBUG they would become promises to the compiler instead, which is worse: no build has either.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
