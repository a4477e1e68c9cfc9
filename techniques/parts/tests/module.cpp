// The session of the tests' scenes registers its module's shaders: here there are none.
#include "volmark/module.h"

extern "C" const volmark::ModuleDescription* volmarkModule() {
  static const volmark::ModuleDescription description{.family = "parts"};
  return &description;
}
