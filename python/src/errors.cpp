// Exceptions of the library as Python's.
#include "errors.h"

#include <nanobind/stl/vector.h>
#include <sherd/error.h>

#include <exception>
#include <new>
#include <system_error>

#include "text.h"

namespace pysherd {
namespace {

// Raises pysherd._errors.error(code, sentence, options), which chooses the class.
void raise(int code, const std::string& sentence, const sherd::OptionNames& options) {
  try {
    const nb::object make = nb::module_::import_("pysherd._errors").attr("error");
    const nb::object error = make(code, sentence, options);
    PyErr_SetObject(error.type().ptr(), error.ptr());
  } catch (nb::python_error& e) {  // such as no memory for it
    e.restore();
  }
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const sherd::Error& e) {
    raise(static_cast<int>(e.code()), e.what(), e.options());
  } catch (const std::system_error& e) {
    raise(static_cast<int>(sherd::ErrorCode::internal), e.what(), {});
  }
}

}  // namespace

void bindErrors() { nb::register_exception_translator(translate); }

}  // namespace pysherd
