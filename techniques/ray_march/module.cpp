#include "volmark/module.h"

#include "dvr_raymarch.h"
#include "iso_raymarch.h"

VOLMARK_MODULE(ray_march, volmark::ray_march::isoRaymarch(), volmark::ray_march::dvrRaymarch())
