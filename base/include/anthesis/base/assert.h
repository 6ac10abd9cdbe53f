#pragma once

/// Our own mistakes stop here, in Debug and RelWithDebInfo. Other people's data never gets this far: it is an Error.
#ifdef NDEBUG
#define ANTHESIS_ASSERT(condition) ((void)0)
#else
#include <cassert>
#define ANTHESIS_ASSERT(condition) assert(condition)
#endif
