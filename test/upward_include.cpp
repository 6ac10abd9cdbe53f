#include "anthesis/inflorescence/species.h"
