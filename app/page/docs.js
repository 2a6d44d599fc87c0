// Starts Swagger UI: a file of its own, since the policy of the page allows no script within it.

const { SwaggerUIBundle } = window;

SwaggerUIBundle({
  url: "openapi.json", // beside the page, also under the path where a proxy shows the service
  dom_id: "#swagger-ui",
  presets: [SwaggerUIBundle.presets.apis, SwaggerUIBundle.SwaggerUIStandalonePreset],
  layout: "BaseLayout",
  deepLinking: true,
  showExtensions: true,
  showCommonExtensions: true,
});
