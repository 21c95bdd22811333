# Build: the compiler and nothing else. Run: a bare Debian with the one binary, as a user of its own.
FROM rust:1.95-bookworm AS build
WORKDIR /build
COPY Cargo.toml Cargo.lock askama.toml build.rs ./
COPY src src
COPY crates crates
COPY tools tools
COPY migrations migrations
COPY openapi openapi
COPY examples examples
COPY docs docs
COPY tests tests
RUN cargo build --release --locked --bin herringbone \
 && cp target/release/herringbone /herringbone

FROM debian:bookworm-slim
RUN apt-get update \
 && apt-get install --yes --no-install-recommends curl \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --system --create-home --home-dir /var/lib/herringbone --shell /usr/sbin/nologin herringbone
COPY --from=build /herringbone /usr/local/bin/herringbone
USER herringbone
WORKDIR /var/lib/herringbone
VOLUME /var/lib/herringbone
# The container's address can be reached from other machines, so the service starts only with a token, or when told that
# something else keeps strangers out:
#   docker run -p 8080:8080 -v "$PWD/token:/run/secrets/token:ro" -e HERRINGBONE_TOKEN_FILE=/run/secrets/token herringbone
#   docker run -p 127.0.0.1:8080:8080 -e HERRINGBONE_INSECURE=true -e HERRINGBONE_ALLOWED_HOSTS=localhost herringbone
ENV HERRINGBONE_LISTEN=0.0.0.0:8080 \
    HERRINGBONE_DATABASE=/var/lib/herringbone/herringbone.db
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=3s --start-period=5s \
  CMD curl --fail --silent http://127.0.0.1:8080/healthz || exit 1
ENTRYPOINT ["herringbone"]
CMD ["serve"]
