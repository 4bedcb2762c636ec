//! Certificates of the server.

use std::path::{Path, PathBuf};

use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};

/// Why a certificate cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentityError {
    /// A file that cannot be read, or does not have what it must.
    #[error("{}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        why: rustls::pki_types::pem::Error,
    },
    /// A file without a certificate.
    #[error("{}: there is no certificate", .0.display())]
    Empty(PathBuf),
    /// A certificate cannot be made.
    #[error(transparent)]
    Make(#[from] rcgen::Error),
    /// The certificate and its key do not serve.
    #[error(transparent)]
    Tls(#[from] rustls::Error),
}

/// Proves to clients which server they talk to: certificates and the key of the first.
pub struct Identity {
    chain: Vec<CertificateDer<'static>>,
    /// Of one that is self-signed.
    pem: String,
    key: PrivateKeyDer<'static>,
}

impl Identity {
    /// A new certificate for some host names or addresses. Clients must be given it beforehand.
    ///
    /// # Errors
    /// Refuses names that no certificate can have.
    pub fn self_signed(names: &[&str]) -> Result<Self, IdentityError> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let rcgen::CertifiedKey { cert, signing_key } = rcgen::generate_simple_self_signed(names)?;
        let key = PrivateKeyDer::Pkcs8(signing_key.serialize_der().into());
        Ok(Self { pem: cert.pem(), chain: vec![cert.into()], key })
    }

    /// Certificates, that of the server first, and its key from PEM files.
    ///
    /// # Errors
    /// Refuses files that cannot be read, or hold no certificate or no key.
    pub fn from_pem_files(certificates: &Path, key: &Path) -> Result<Self, IdentityError> {
        let refuse = |path: &Path| {
            let path = path.to_owned();
            move |why| IdentityError::File { path, why }
        };
        let chain: Vec<_> = CertificateDer::pem_file_iter(certificates)
            .and_then(Iterator::collect)
            .map_err(refuse(certificates))?;
        if chain.is_empty() {
            return Err(IdentityError::Empty(certificates.to_owned()));
        }
        let key = PrivateKeyDer::from_pem_file(key).map_err(refuse(key))?;
        Ok(Self { chain, pem: String::new(), key })
    }

    /// The certificate of the server, as DER: what a client must trust if it is self-signed.
    pub fn certificate(&self) -> &[u8] {
        self.chain.first().map_or(&[], |certificate| certificate.as_ref())
    }

    /// A certificate that was made by [`Identity::self_signed`], as PEM; empty otherwise.
    pub fn certificate_pem(&self) -> &str {
        &self.pem
    }

    /// What a server speaks with: TLS 1.3, without data before the handshake ends.
    pub(crate) fn tls(&self, protocol: &[u8]) -> Result<rustls::ServerConfig, IdentityError> {
        let provider = rustls::crypto::ring::default_provider().into();
        let mut tls = rustls::ServerConfig::builder_with_provider(provider)
            .with_protocol_versions(&[&rustls::version::TLS13])?
            .with_no_client_auth()
            .with_single_cert(self.chain.clone(), self.key.clone_key())?;
        tls.alpn_protocols = vec![protocol.to_vec()];
        Ok(tls)
    }
}

impl Clone for Identity {
    fn clone(&self) -> Self {
        Self { chain: self.chain.clone(), pem: self.pem.clone(), key: self.key.clone_key() }
    }
}

impl std::fmt::Debug for Identity {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Identity")
    }
}
