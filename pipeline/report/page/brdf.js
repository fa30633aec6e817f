// brdf
